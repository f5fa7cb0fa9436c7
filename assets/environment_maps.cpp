#include "assets/environment_maps.hpp"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "runtime/sh/image_layout.hpp"

namespace lambent::assets {

spec::RgbImage latLongImage(std::uint32_t width, int samples,
                            const std::function<glm::dvec3(glm::dvec3 dir)>& radiance) {
  spec::RgbImage image{width, width / 2, {}};
  const int fine_width = static_cast<int>(width) * samples, fine_height = fine_width / 2;
  for (int y = 0; y < static_cast<int>(image.height); ++y)
    for (int x = 0; x < static_cast<int>(image.width); ++x) {
      glm::dvec3 sum(0.0);
      for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i)
          sum += radiance(sh::texelDirection(sh::ImageLayout::LatLong, fine_width, fine_height,
                                             x * samples + i, y * samples + j));
      image.texels.emplace_back(sum / double(samples * samples));
    }
  return image;
}

glm::dvec3 integrate(const spec::RgbImage& image) {
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  glm::dvec3 sum(0.0);
  for (int y = 0; y < height; ++y) {
    glm::dvec3 row(0.0);
    for (int x = 0; x < width; ++x)
      row +=
          glm::dvec3(image.texels[static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x)]);
    sum += row * sh::texelSolidAngle(sh::ImageLayout::LatLong, width, height, 0, y);
  }
  return sum;
}

void normalise(spec::RgbImage& image) {
  const glm::dvec3 rec709(0.2126, 0.7152, 0.0722);
  const double mean = glm::dot(integrate(image), rec709) / (4 * std::numbers::pi);
  for (glm::vec3& texel : image.texels) texel *= static_cast<float>(1.0 / mean);
}

}  // namespace lambent::assets
