// The sky as the light capture sees it: one small cube in world axes for all points, box-filtered, without
// suns. Comes in: an environment. Goes out: per texel (order of sh/cube_map.hpp) its
// radiance and the weights that take it to harmonics, and the sum of both, made anew by two
// dispatches when the environment turned, faded or is another. Errors: shaders that
// do not compile on this device.
#pragma once

#include <array>
#include <cstdint>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/capture_scene.hpp"
#include "runtime/lighting/environment.hpp"

namespace lambent::lighting {

class CaptureSky {
 public:
  CaptureSky() = default;
  static Result<CaptureSky> create(const CaptureOptions& options, const Environment& environment);

  // Does nothing if the environment is as it was. True if the cube was made anew.
  // weights: [texel][coefficient], sh::cubeWeights.
  bool update(const Environment& environment, const gpu::Buffer& weights, gpu::Counters& counters);
  // Makes the cube with the environment maps turned in any way, for measurements; the next update() makes it
  // anew.
  void makeTurned(const Environment& environment, const glm::mat3& world_from_light,
                  const gpu::Buffer& weights);
  // For capture_project.comp.
  void bindTables();
  // vec4 per coefficient: the sum of texels times weights.
  const gpu::Buffer& light() const { return light_; }

 private:
  void takeLights(const Environment& environment);

  CaptureOptions options_;
  gpu::Program program_, light_program_;
  std::array<gpu::Texture, Environment::kSets>
      environment_maps_;  // in the lights' own frame, float32, with mip maps
  gpu::Sampler sampler_;
  gpu::Buffer texels_, weights_, light_;
  gpu::Handle<gpu::TextureTraits> texels_view_, weights_view_;
  std::uint64_t version_ = 0;  // of the environment that the cube shows; 0: of none
  std::uint64_t lights_ = 0;   // version of those in the environment maps' cubes
};

}  // namespace lambent::lighting
