#include "runtime/spec/display.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace lambent::spec {

namespace {

// The names and the order of terms are those of tone_curve.glsl.
constexpr float kLargest = 65504.0f;

glm::vec3 toneCurve(glm::vec3 linear) {
  constexpr float kStart = 0.8f - 0.04f, kDesaturation = 0.15f;
  const float low = std::min({linear.r, linear.g, linear.b});
  glm::vec3 mapped = linear - (low < 0.08f ? low - 6.25f * low * low : 0.04f);
  const float peak = std::max({mapped.r, mapped.g, mapped.b});
  if (peak < kStart) return mapped;
  constexpr float kRange = 1.0f - kStart;
  const float new_peak = 1.0f - kRange * kRange / (peak + kRange - kStart);
  mapped *= new_peak / peak;
  const float to_white = 1.0f - 1.0f / (kDesaturation * (peak - new_peak) + 1.0f);
  return glm::mix(mapped, glm::vec3(new_peak), to_white);
}

float srgbFromLinear(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

}  // namespace

Rgba8Image displayed(const RgbaImage& linear) {
  Rgba8Image out{linear.width, linear.height, {}};
  out.texels.reserve(4 * linear.texels.size());
  for (const glm::vec4& texel : linear.texels) {
    const glm::vec3 shown = toneCurve(glm::clamp(glm::vec3(texel), glm::vec3(0.0f), glm::vec3(kLargest)));
    for (int c = 0; c < 3; ++c)
      out.texels.push_back(
          static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(srgbFromLinear(shown[c]), 0.0f, 1.0f))));
    out.texels.push_back(255);
  }
  return out;
}

}  // namespace lambent::spec
