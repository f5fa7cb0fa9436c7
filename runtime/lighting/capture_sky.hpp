// The sky as the light capture sees it: one small cube in world axes for all points, box-filtered, without
// suns. Comes in: an environment. Goes out: a vec4 per texel (order of sh/cube_map.hpp), made anew by one
// dispatch when the environment turned or faded, and the exact light that it stands for. Errors: shaders that
// do not compile on this device.
#pragma once

#include <cstdint>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/capture_scene.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/sh/light_vector.hpp"

namespace lambent::lighting {

class CaptureSky {
 public:
  CaptureSky() = default;
  static Result<CaptureSky> create(const CaptureOptions& options, const Environment& environment);

  // Does nothing if the environment is as it was. True if the cube was made anew.
  bool update(const Environment& environment, gpu::Counters& counters);
  // Makes the cube with the probes turned in any way, for measurements; the next update() makes it anew.
  void makeTurned(const glm::mat3& world_from_light, const glm::vec3& constant_radiance);
  void bindStorage(GLuint binding) const { texels_.bindStorage(binding); }
  const gpu::Buffer& texels() const { return texels_; }
  // What the sky without its suns sends to a point from which nothing hides it; bands as the options say.
  sh::LightVector light(const Environment& environment) const;

 private:
  CaptureOptions options_;
  gpu::Program program_;
  gpu::Texture probes_;  // in the lights' own frame, float32, with mip maps
  gpu::Sampler sampler_;
  gpu::Buffer texels_;
  std::uint64_t version_ = 0;  // of the environment that the cube shows; 0: of none
  sh::LightVector unturned_;
};

}  // namespace lambent::lighting
