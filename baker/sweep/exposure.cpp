#include "baker/sweep/exposure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "runtime/spec/display.hpp"
#include "runtime/spec/rec709.hpp"

namespace lambent::baker {

float exposureOf(const spec::RgbaImage& reference) {
  constexpr double kMiddle = 1.0 / 3.0;
  double sum = 0.0, covered = 0.0;
  for (const glm::vec4& texel : reference.texels) {
    if (!(texel.w >= spec::kLeastCoverage)) continue;
    // Highlights are clipped on a screen and should not darken all else.
    sum += std::min(10.0, static_cast<double>(std::max(0.0f, spec::luminanceOf(texel))));
    covered += 1.0;
  }
  return sum > 0.0 ? static_cast<float>(kMiddle * covered / sum) : 1.0f;
}

spec::Rgba8Image shownWith(const spec::RgbaImage& picture, float exposure) {
  spec::RgbaImage exposed = picture;
  for (glm::vec4& texel : exposed.texels) texel = glm::vec4(glm::vec3(texel) * exposure, texel.w);
  return spec::displayed(exposed);
}

spec::RgbaImage meanOf(const spec::RgbaImage& a, const spec::RgbaImage& b) {
  spec::RgbaImage mean = a;
  for (std::size_t i = 0; i < mean.texels.size(); ++i) mean.texels[i] = 0.5f * (a.texels[i] + b.texels[i]);
  return mean;
}

}  // namespace lambent::baker
