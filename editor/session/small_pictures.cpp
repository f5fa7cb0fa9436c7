#include "editor/session/small_pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

namespace lambent::editor {

namespace {

constexpr std::uint32_t kMapWidth = 128, kMapHeight = 64;
constexpr std::uint32_t kViewWidth = 192, kViewHeight = 108;
static_assert(kViewWidth == kSmallPictureShape * kViewHeight);

std::uint8_t coded(float value) {
  const float clamped = std::clamp(value, 0.0f, 1.0f);
  return static_cast<std::uint8_t>(255.0f * std::pow(clamped, 1.0f / 2.2f) + 0.5f);
}

}  // namespace

spec::Rgba8Image smallPictureOf(const spec::RgbImage& environment_map) {
  std::vector<glm::vec3> texels;
  std::vector<float> brightness;
  for (std::uint32_t y = 0; y < kMapHeight; ++y)
    for (std::uint32_t x = 0; x < kMapWidth; ++x) {
      const std::size_t from_x = (2 * std::size_t{x} + 1) * environment_map.width / (2 * kMapWidth);
      const std::size_t from_y = (2 * std::size_t{y} + 1) * environment_map.height / (2 * kMapHeight);
      texels.push_back(environment_map.texels[from_y * environment_map.width + from_x]);
      const float luminance = glm::dot(texels.back(), glm::vec3(0.2126f, 0.7152f, 0.0722f));
      brightness.push_back(std::isfinite(luminance) ? luminance : 0.0f);
    }
  const auto median = brightness.begin() + kMapWidth * kMapHeight / 2;
  std::nth_element(brightness.begin(), median, brightness.end());
  const float scale = 0.22f / std::max(1e-6f, *median);
  spec::Rgba8Image made{kMapWidth, kMapHeight, {}};
  for (const glm::vec3& texel : texels)
    for (const float value : {texel.r, texel.g, texel.b, 1.0f / scale})
      made.texels.push_back(std::isfinite(value) ? coded(scale * value) : std::uint8_t{255});
  return made;
}

spec::Rgba8Image smallPictureOf(const spec::Rgba8Image& view) {
  // The part of the view that is shown: as wide or as high as the view, and in the shape of the small
  // picture.
  const std::uint32_t width = std::min(view.width, view.height * kViewWidth / kViewHeight);
  const std::uint32_t height = std::min(view.height, view.width * kViewHeight / kViewWidth);
  const std::uint32_t left = (view.width - width) / 2, top = (view.height - height) / 2;
  spec::Rgba8Image made{kViewWidth, kViewHeight, {}};
  for (std::uint32_t y = 0; y < kViewHeight; ++y)
    for (std::uint32_t x = 0; x < kViewWidth; ++x) {
      const std::uint32_t x_begin = left + x * width / kViewWidth, y_begin = top + y * height / kViewHeight;
      const std::uint32_t x_end = std::max(x_begin + 1, left + (x + 1) * width / kViewWidth);
      const std::uint32_t y_end = std::max(y_begin + 1, top + (y + 1) * height / kViewHeight);
      std::array<std::uint32_t, 3> sum{};
      for (std::uint32_t from_y = y_begin; from_y < y_end; ++from_y)
        for (std::uint32_t from_x = x_begin; from_x < x_end; ++from_x)
          for (std::size_t channel = 0; channel < 3; ++channel)
            sum[channel] += view.texels[4 * (std::size_t{from_y} * view.width + from_x) + channel];
      const std::uint32_t count = (x_end - x_begin) * (y_end - y_begin);
      for (const std::uint32_t channel : sum)
        made.texels.push_back(static_cast<std::uint8_t>((channel + count / 2) / count));
      made.texels.push_back(255);
    }
  return made;
}

}  // namespace lambent::editor
