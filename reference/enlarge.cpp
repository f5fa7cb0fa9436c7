#include "reference/enlarge.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace lambent::baker::reference {

namespace {

// A TexelPlace lies between texels `low` and `high`; `share` is the weight of `high`.
struct TexelPlace {
  std::size_t low, high;
  float share;
};

std::vector<TexelPlace> places(std::uint32_t from, std::uint32_t to) {
  std::vector<TexelPlace> out;
  out.reserve(to);
  for (std::uint32_t i = 0; i < to; ++i) {
    const double at = std::clamp((i + 0.5) * from / to - 0.5, 0.0, from - 1.0);
    const auto low = static_cast<std::size_t>(at);
    out.push_back({low, std::min<std::size_t>(low + 1, from - 1), static_cast<float>(at - std::floor(at))});
  }
  return out;
}

}  // namespace

spec::RgbaImage enlarged(const spec::RgbaImage& image, const spec::Size& size) {
  const std::vector<TexelPlace> columns = places(image.width, size.width),
                                rows = places(image.height, size.height);
  spec::RgbaImage out{.width = size.width, .height = size.height, .texels = {}};
  out.texels.reserve(std::size_t{size.width} * size.height);
  for (const TexelPlace& y : rows)
    for (const TexelPlace& x : columns) {
      const auto between = [&](std::size_t row) {
        return glm::mix(image.texels[row * image.width + x.low], image.texels[row * image.width + x.high],
                        x.share);
      };
      out.texels.push_back(glm::mix(between(y.low), between(y.high), y.share));
    }
  return out;
}

}  // namespace lambent::baker::reference
