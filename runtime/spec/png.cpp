// Reads and writes PNG with stb, whose code is compiled only here.
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <vector>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb/stb_image.h>
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

#include "runtime/base/atomic_file.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::spec {

namespace {

// The chunks that say that values are sRGB: "sRGB", and for programs that do not know it the gamma and the
// chromaticities that the PNG specification gives for it (11.3.2.5). Each has its length, name, content and
// check (CRC-32).
constexpr std::uint8_t kSrgbChunks[] = {
    0x00, 0x00, 0x00, 0x01, 0x73, 0x52, 0x47, 0x42, 0x00, 0xae, 0xce, 0x1c, 0xe9, 0x00, 0x00,
    0x00, 0x04, 0x67, 0x41, 0x4d, 0x41, 0x00, 0x00, 0xb1, 0x8f, 0x0b, 0xfc, 0x61, 0x05, 0x00,
    0x00, 0x00, 0x20, 0x63, 0x48, 0x52, 0x4d, 0x00, 0x00, 0x7a, 0x26, 0x00, 0x00, 0x80, 0x84,
    0x00, 0x00, 0xfa, 0x00, 0x00, 0x00, 0x80, 0xe8, 0x00, 0x00, 0x75, 0x30, 0x00, 0x00, 0xea,
    0x60, 0x00, 0x00, 0x3a, 0x98, 0x00, 0x00, 0x17, 0x70, 0x9c, 0xba, 0x51, 0x3c};

}  // namespace

Result<Rgba8Image> readPng(const std::filesystem::path& path) {
  const Result<std::string> bytes = readTextFile(path);
  if (!bytes) return failAgain(bytes.error());
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes->data());
  const int length = static_cast<int>(std::min<std::size_t>(bytes->size(), 1u << 30));
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(data, length, &width, &height, &channels))
    return fail(path.string(), "is not a PNG picture", "name a .png file");
  // Deflate compresses at most about 1000 to 1.
  if (const auto checked =
          checkImageSize(path, static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height),
                         bytes->size(), /*texels_per_byte=*/8200);
      !checked)
    return failAgain(checked.error());
  const std::unique_ptr<stbi_uc, void (*)(void*)> texels(
      stbi_load_from_memory(data, length, &width, &height, &channels, 4), stbi_image_free);
  if (!texels)
    return fail(path.string(), std::string("is a damaged PNG: ") + stbi_failure_reason(), "copy it again");
  Rgba8Image image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  image.texels.assign(texels.get(), texels.get() + std::size_t{4} * image.width * image.height);
  return image;
}

std::vector<std::uint8_t> encodePng(const Rgba8Image& image) {
  std::vector<std::uint8_t> bytes;
  const auto append = [](void* context, void* data, int size) {
    const auto* first = static_cast<const std::uint8_t*>(data);
    static_cast<std::vector<std::uint8_t>*>(context)->insert(
        static_cast<std::vector<std::uint8_t>*>(context)->end(), first, first + size);
  };
  const int width = static_cast<int>(image.width);
  stbi_write_png_to_func(append, &bytes, width, static_cast<int>(image.height), 4, image.texels.data(),
                         4 * width);
  return bytes;
}

Result<void> writePng(const std::filesystem::path& path, const Rgba8Image& image) {
  std::vector<std::uint8_t> bytes = encodePng(image);
  if (bytes.empty()) return fail(path.string(), "cannot be coded as PNG", "make the picture smaller");
  constexpr std::ptrdiff_t kHeaderEnd = 8 + 4 + 4 + 13 + 4;  // the signature and the chunk IHDR
  bytes.insert(bytes.begin() + kHeaderEnd, std::begin(kSrgbChunks), std::end(kSrgbChunks));
  return writeFile(path, std::as_bytes(std::span(bytes)));
}

}  // namespace lambent::spec
