// Computes the lobe with which a rough surface blurs its reflection of the sky. It is taken to be
// rotationally symmetric about the mirrored view, as if one looked along the normal (Karis 2013, split sum):
// K(theta) ~ D_GGX(theta / 2) max(cos theta, 0) with integral 1, theta measured from the mirrored direction.
// No GL.
#pragma once

#include <array>
#include <vector>

#include "runtime/sh/basis.hpp"

namespace lambent::lighting {

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

}  // namespace lambent::lighting
