// What the camera sees where nothing stands: the environment's own radiance, not its spherical harmonics.
// Environment maps and constants are resampled once into a cube map per set of lights (half floats, clamped
// to what those hold); suns stay analytic discs with an edge one pixel wide. Turned, faded and scaled as the
// environment is when it is drawn, and resampled anew when update() meets other lights. Drawn behind
// everything, with alpha 0: the sky covers nothing. Errors: shaders that do not compile on this device.
#pragma once

#include <array>
#include <span>

#include <glm/mat4x4.hpp>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/environment.hpp"

namespace lambent::lighting {

// Environment maps and a constant in their own frame, resampled: about one texel of the cube per texel of the
// environment maps.
gpu::Texture skyCube(std::span<const spec::EnvironmentMap* const> environment_maps, glm::vec3 constant);

class Sky {
 public:
  static Result<Sky> create(const Environment& environment);

  bool upToDate(const Environment& environment) const { return lights_ == environment.lightsVersion(); }
  // Does nothing unless other lights were loaded, or key lights edited, since; true if it did.
  bool update(const Environment& environment);
  // Into the bound framebuffer, where its depth is still that of the clear. Only the rotation of
  // view_from_world is used.
  void draw(const Environment& environment, const glm::mat4& view_from_world, const glm::mat4& clip_from_view,
            std::uint32_t picture_height, gpu::Counters& counters) const;

  // Environment maps and constants of a set of lights, in their own frame.
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
