// Texture images, PNG or JPEG as they lie in a bundle, to texels: four channels of 8 bits, row 0 at the top,
// colour still sRGB-coded, alpha 1 where the file has none. Errors name `subject`. Safe from any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::streaming {

// Per side, texels: what OpenGL 4.5 drivers take. Larger images are refused before any memory is asked for.
inline constexpr std::uint32_t kMaxImageSide = 16384;

struct ImageSize {
  std::uint32_t width = 0, height = 0;
  std::size_t rgbaBytes() const { return std::size_t{4} * width * height; }
};

// From the header alone. Errors: not a PNG or JPEG, empty, a side over kMaxImageSide.
Result<ImageSize> imageSize(std::span<const std::byte> file, const std::string& subject);

// Errors: those of imageSize, damaged data.
Result<std::vector<std::uint8_t>> decodeRgba(std::span<const std::byte> file, const std::string& subject);

}  // namespace lambent::streaming
