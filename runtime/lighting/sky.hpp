// Draws what the camera sees where no surface is: the environment's own radiance, not its spherical
// harmonics. Environment maps and constants are resampled once into a cube map per set of lights (half
// floats, clamped to their range); suns stay analytic discs with an edge one pixel wide. The sky is turned,
// faded and scaled with the environment when it is drawn, and resampled when update() meets other lights. It
// is drawn behind everything with alpha 0, because the sky covers nothing. Render thread only. create() fails
// if a shader does not compile on this device.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/prefiltered_shared.h"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/window.hpp"

namespace lambent::lighting {

// The tables of GLSL text that programs of this room include files from.
extern const gpu::FindText kLightingShaders[1];

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

// Owns what rough mirrors show of the sky beyond the few SH bands that surfaces receive: P(L) - P(L_n),
// prefiltered with a round lobe. L is the light without key lights, whose
// highlights surfaces shade from their discs; where key lights are wide (pieces of windows or soft boxes),
// their true shape is kept in second cube maps of all light, for mirrors that are sharp enough to show it.
// P(L) is a cube map per set of lights with roughness along its mip levels, in the lights' own frame; it is
// made once, and turning, fading and dimming only change how it is mixed. P(L_n) has n bands, each scaled by
// the lobe's, and is subtracted where a surface looks it up (specular_environment.glsl), so that light of few
// bands leaves nothing. Render thread only. make() fails if a kernel does not compile on this device.

// Computes the lobe with which a rough surface blurs its reflection of the sky. It is taken to be
// rotationally symmetric about the mirrored view, as if one looked along the normal (Karis 2013, split sum):
// K(theta) ~ D_GGX(theta / 2) max(cos theta, 0) with integral 1, theta measured from the mirrored direction.
// No GL.
struct ReflectedLobe {
  float alpha = 0.0f;             // 0: a mirror
  float scale = 0.0f;             // K = scale * cos(theta) / (cos²(theta/2) (alpha² - 1) + 1)²
  std::vector<float> angles_rad;  // the centres of kLobeShares equal shares of the lobe
  // The lobe scales the bands of light by these factors: ∫ K P_l(cos theta).
  std::array<float, sh::kMaxOrder> bands{};

  float density(float cos_theta) const;
};

inline constexpr int kLobeShares = 256;

// Makes the lobe for a perceptual roughness, 0..1; alpha = roughness².
ReflectedLobe makeReflectedLobe(float roughness);

// Returns the roughness of a mip level. Steps are finer where the lobe is narrow. specular_environment.glsl
// has the inverse.
float roughnessOfLevel(std::uint32_t level, std::uint32_t levels);

class PrefilteredEnvironment {
 public:
  // `sky` must be the sky of this environment.
  static Result<PrefilteredEnvironment> make(const Environment& environment, const Sky& sky,
                                             gpu::Counters& counters);
  // Returns a version: make() gives the same result if it is the same.
  static std::uint64_t sourceVersion(const Environment& environment);

  // Updates the uniform block to the current environment and to the light that surfaces have of it: this many
  // bands, windowed.
  void update(const Environment& environment, int order, sh::Window window, gpu::Counters& counters);
  void bind() const;

  // Return what was uploaded, for tests.
  const ReflectionValues& values() const { return values_; }
  const gpu::Texture& cube(std::size_t set) const { return cubes_[set]; }

 private:
  PrefilteredEnvironment() : block_("reflection") {}

  std::array<gpu::Texture, Environment::kSets> cubes_, whole_;
  bool has_whole_ = false;
  ReflectionValues values_{};
  gpu::Table block_;
  ChangeGate<std::uint64_t, int, sh::Window> changed_;  // environment, order, window
};

}  // namespace lambent::lighting
