#include "baker/accuracy/shrink.hpp"

#include <fmt/format.h>

namespace lambent::baker {

Result<spec::RgbaImage> shrunk(const spec::RgbaImage& picture, std::uint32_t n, const std::string& subject) {
  if (n == 1) return picture;
  if (n < 1 || picture.width % n != 0 || picture.height % n != 0)
    return fail(subject,
                fmt::format("{} x {} pixels cannot be shrunk by {}", picture.width, picture.height, n),
                "shrink by a number that divides both");
  spec::RgbaImage out{picture.width / n, picture.height / n, {}};
  out.texels.reserve(std::size_t{out.width} * out.height);
  const double share = 1.0 / (static_cast<double>(n) * static_cast<double>(n));
  for (std::uint32_t y = 0; y < out.height; ++y)
    for (std::uint32_t x = 0; x < out.width; ++x) {
      glm::dvec4 sum(0.0);
      for (std::uint32_t row = y * n; row < (y + 1) * n; ++row)
        for (std::uint32_t column = x * n; column < (x + 1) * n; ++column)
          sum += glm::dvec4(picture.texels[std::size_t{row} * picture.width + column]);
      out.texels.emplace_back(share * sum);
    }
  return out;
}

}  // namespace lambent::baker
