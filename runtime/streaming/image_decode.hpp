// Decodes texture images (PNG or JPEG) of a bundle. Texels have four channels of 8 bits, with row 0 at the
// top, and colours stay sRGB-coded. Alpha is 1 if the file has none. Errors name `subject`. The functions may
// be called from any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::streaming {

// Largest width and height in texels, which OpenGL 4.5 drivers support. Larger images are rejected before any
// memory is allocated.
inline constexpr std::uint32_t kMaxImageSide = 16384;

struct ImageSize {
  std::uint32_t width = 0, height = 0;
  std::size_t rgbaBytes() const { return std::size_t{4} * width * height; }
};

// Reads the size from the header alone. Fails if the file is no PNG or JPEG, is empty, or has a side over
// kMaxImageSide.
Result<ImageSize> imageSize(std::span<const std::byte> file, const std::string& subject);

// Fails as imageSize does, and if the data are damaged.
Result<std::vector<std::uint8_t>> decodeRgba(std::span<const std::byte> file, const std::string& subject);

}  // namespace lambent::streaming
