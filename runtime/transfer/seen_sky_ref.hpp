// This is the CPU twin of seen_sky.glsl, with the same names. No GL.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "runtime/sh/basis.hpp"
#include "runtime/transfer/seen_sky_shared.h"

namespace lambent::transfer::ref {

inline std::array<float, kSeenBands> seenBands(std::span<const float, kSeenCoefficients> c,
                                               const glm::vec3& d) {
  std::array<float, kSeenCoefficients> y;
  sh::evaluate(static_cast<int>(kSeenBands), d, y);
  std::array<float, kSeenBands> bands{};
  for (std::size_t l = 0; l < bands.size(); ++l)
    for (std::size_t k = l * l; k < (l + 1) * (l + 1); ++k) bands[l] += c[k] * y[k];
  return bands;
}

inline float seenShare(std::span<const float, kSeenCoefficients> c, std::span<const float> weights,
                       std::span<const glm::vec3> axes, const glm::mat3& frame) {
  float sum = 0.0f;
  for (std::size_t i = 0; i < kSeenBands; ++i) {
    const std::array<float, kSeenBands> bands = seenBands(c, frame * axes[i]);
    for (std::size_t l = i; l < kSeenBands; ++l) sum += weights[l * (l + 1) / 2 + i] * bands[l];
  }
  return std::clamp(sum, 0.0f, 1.0f);
}

inline float seenShareOfAll(std::span<const float, kSeenCoefficients> c) {
  return std::clamp(3.5449077f * c[0], 0.0f, 1.0f);
}

}  // namespace lambent::transfer::ref
