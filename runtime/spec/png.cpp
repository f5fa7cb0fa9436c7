// Reads and writes PNG with stb, whose code is compiled only here.
#include <algorithm>
#include <cstddef>
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

void appendNumber(std::vector<std::uint8_t>& bytes, std::uint32_t number) {
  for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<std::uint8_t>(number >> shift));
}

// Returns the cyclic redundancy check of ISO 3309, which ends each chunk. Chunks here have a few bytes.
std::uint32_t checkOf(std::span<const std::uint8_t> bytes) {
  std::uint32_t rest = ~0u;
  for (const std::uint8_t byte : bytes) {
    rest ^= byte;
    for (int bit = 0; bit < 8; ++bit) rest = (rest >> 1) ^ ((rest & 1u) != 0 ? 0xEDB88320u : 0u);
  }
  return ~rest;
}

void appendChunk(std::vector<std::uint8_t>& bytes, const char (&name)[5],
                 std::span<const std::uint8_t> content) {
  appendNumber(bytes, static_cast<std::uint32_t>(content.size()));
  const std::size_t checked_from = bytes.size();
  bytes.insert(bytes.end(), name, name + 4);
  bytes.insert(bytes.end(), content.begin(), content.end());
  appendNumber(bytes, checkOf(std::span(bytes).subspan(checked_from)));
}

// Returns the chunks that say that values are sRGB: "sRGB", and for programs that do not know it the gamma
// and the chromaticities that the PNG specification gives for it (11.3.2.5).
std::vector<std::uint8_t> srgbChunks() {
  constexpr std::uint8_t kPerceptual = 0;
  std::vector<std::uint8_t> bytes, gamma, chromaticities;
  appendNumber(gamma, 45455);
  for (const std::uint32_t value : {31270u, 32900u, 64000u, 33000u, 30000u, 60000u, 15000u, 6000u})
    appendNumber(chromaticities, value);
  appendChunk(bytes, "sRGB", std::span(&kPerceptual, 1));
  appendChunk(bytes, "gAMA", gamma);
  appendChunk(bytes, "cHRM", chromaticities);
  return bytes;
}

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
  const std::vector<std::uint8_t> chunks = srgbChunks();
  bytes.insert(bytes.begin() + kHeaderEnd, chunks.begin(), chunks.end());
  return writeFile(path, std::as_bytes(std::span(bytes)));
}

}  // namespace lambent::spec
