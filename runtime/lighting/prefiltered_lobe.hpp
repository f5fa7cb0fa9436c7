// The lobe with which a rough surface blurs the sky that it reflects, taken to be round about the mirrored
// view, as if one looked along the normal (Karis 2013, split sum): K(theta) ~ D_GGX(theta / 2) max(cos theta,
// 0), of integral 1, theta against the mirrored direction. No GL.
#pragma once

#include <array>
#include <vector>

#include "runtime/sh/basis.hpp"

namespace lambent::lighting {

struct ReflectedLobe {
  float alpha = 0.0f;             // 0: a mirror
  float scale = 0.0f;             // K = scale * cos(theta) / (cos²(theta/2) (alpha² - 1) + 1)²
  std::vector<float> angles_rad;  // of equal shares of the lobe: the middles of kLobeShares
  // By what the lobe scales the bands of light: ∫ K P_l(cos theta).
  std::array<float, sh::kMaxOrder> bands{};

  float density(float cos_theta) const;
};

inline constexpr int kLobeShares = 256;

// roughness 0..1, perceptual; alpha = roughness².
ReflectedLobe makeReflectedLobe(float roughness);

// Roughness of a mip level of `levels`: finer steps where the lobe is narrow. Its inverse is in
// glossy_surface.glsl.
float roughnessOfLevel(std::uint32_t level, std::uint32_t levels);

}  // namespace lambent::lighting
