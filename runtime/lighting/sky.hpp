// Draws what the camera sees where no surface is: the environment's own radiance, not its spherical
// harmonics. Environment maps and constants are resampled once into a cube map per set of lights (half
// floats, clamped to their range); suns stay analytic discs with an edge one pixel wide. The sky is turned,
// faded and scaled with the environment when it is drawn, and resampled when update() meets other lights. It
// is drawn behind everything with alpha 0, because the sky covers nothing. Render thread only. create() fails
// if a shader does not compile on this device.
#pragma once

#include <array>
#include <span>

#include <glm/mat4x4.hpp>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/environment.hpp"

namespace lambent::lighting {

// The tables of GLSL text that programs of this room include files from.
extern const gpu::FindText kLightingShaders[1];

// Resamples environment maps and a constant, in their own frame, with about one texel of the cube per texel
// of the environment maps.
gpu::Texture skyCube(std::span<const spec::EnvironmentMap* const> environment_maps, glm::vec3 constant);

class Sky {
 public:
  static Result<Sky> create(const Environment& environment);

  bool upToDate(const Environment& environment) const { return lights_ == environment.lightsVersion(); }
  // Resamples if other lights were loaded or key lights were edited since; returns whether it did.
  bool update(const Environment& environment);
  // Draws into the bound framebuffer where its depth is still the clear value. Only the rotation of
  // view_from_world is used.
  void draw(const Environment& environment, const glm::mat4& view_from_world, const glm::mat4& clip_from_view,
            std::uint32_t picture_height, gpu::Counters& counters) const;

  // Returns the environment maps and constants of a set of lights, in their own frame.
  const gpu::Texture& cube(std::size_t set) const { return cubes_[set]; }

 private:
  Sky() : discs_("sky discs") {}

  gpu::Program program_;
  std::array<gpu::Texture, Environment::kSets> cubes_;
  gpu::Table discs_;
  gpu::VertexArray no_vertices_;
  std::uint32_t disc_count_ = 0;
  std::uint64_t lights_ = 0, pictures_ = 0;  // versions
};

}  // namespace lambent::lighting
