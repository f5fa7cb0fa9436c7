#include "runtime/streaming/image_decode.hpp"

#include <limits>
#include <memory>

#include <fmt/format.h>

// This room compiles stb_image here only, as static functions, so that it does not collide with other copies
// in a program. It is included as a system header to suppress warnings.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#include <stb/stb_image.h>

namespace lambent::streaming {
namespace {

constexpr const char* kHint = "replace the image in the scene and bake it again";

const stbi_uc* stbBytes(std::span<const std::byte> file) {
  return reinterpret_cast<const stbi_uc*>(file.data());
}

struct FreePixels {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

}  // namespace

Result<ImageSize> imageSize(std::span<const std::byte> file, const std::string& subject) {
  int width = 0, height = 0, channels = 0;
  if (file.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return fail(subject, "is a file of more than 2 GiB", kHint);
  if (stbi_info_from_memory(stbBytes(file), static_cast<int>(file.size()), &width, &height, &channels) == 0)
    return fail(subject, fmt::format("is not a PNG or JPEG that can be read ({})", stbi_failure_reason()),
                kHint);
  if (width <= 0 || height <= 0) return fail(subject, "has no texels", kHint);
  const ImageSize size{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
  if (size.width > kMaxImageSide || size.height > kMaxImageSide)
    return fail(subject,
                fmt::format("has {} x {} texels, more than {} on a side", width, height, kMaxImageSide),
                kHint);
  return size;
}

Result<std::vector<std::uint8_t>> decodeRgba(std::span<const std::byte> file, const std::string& subject) {
  const auto size = imageSize(file, subject);
  if (!size) return failAgain(size.error());
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, FreePixels> pixels(stbi_load_from_memory(
      stbBytes(file), static_cast<int>(file.size()), &width, &height, &channels, STBI_rgb_alpha));
  if (!pixels) return fail(subject, fmt::format("is damaged ({})", stbi_failure_reason()), kHint);
  return std::vector<std::uint8_t>(pixels.get(), pixels.get() + size->rgbaBytes());
}

}  // namespace lambent::streaming
