#include "runtime/sh/projection.hpp"

#include <array>
#include <cassert>
#include <cmath>

namespace lambent::sh {

LightVector projectImage(int order, ImageLayout layout, int width, int height,
                         std::span<const glm::vec3> texels, ProjectionReport* report) {
  assert(texels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto count = static_cast<std::size_t>(coefficientCount(order));
  ProjectionReport seen;
  std::array<std::array<double, kMaxCoefficients>, 3> sum{};
  std::array<double, kMaxCoefficients> basis;

  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double solid_angle_sr = texelSolidAngle(layout, width, height, x, y);
      if (solid_angle_sr <= 0) continue;
      ++seen.covered_texels;
      seen.solid_angle_sr += solid_angle_sr;

      const glm::vec3& radiance =
          texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
      if (!std::isfinite(radiance.r) || !std::isfinite(radiance.g) || !std::isfinite(radiance.b)) {
        ++seen.replaced_texels;
        continue;
      }
      if (radiance.r < 0 || radiance.g < 0 || radiance.b < 0) ++seen.negative_texels;

      evaluate(order, texelDirection(layout, width, height, x, y), basis);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double weight = static_cast<double>(radiance[static_cast<int>(channel)]) * solid_angle_sr;
        for (std::size_t i = 0; i < count; ++i) sum[channel][i] += weight * basis[i];
      }
    }
  }

  if (report) *report = seen;
  LightVector light{.order = order};
  for (std::size_t i = 0; i < count; ++i) light.c[i] = glm::vec3(glm::dvec3(sum[0][i], sum[1][i], sum[2][i]));
  return light;
}

}  // namespace lambent::sh
