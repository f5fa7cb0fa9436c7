// Pictures in and out of files. Read: light images (.hdr Radiance RGBE, .exr OpenEXR scanline or tiled, half
// or float) and our own pictures back. Written: PNG (8 bits, as given: tone mapping and sRGB come before),
// linear EXR (float32 RGBA, depths), Radiance. Row 0 is the top. Values are linear Rec.709. Files are written
// whole or not at all. Errors name the file and say whether it is missing, of another type, truncated,
// damaged or absurdly large; nothing throws.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/result.hpp"

namespace lambent::spec {

// A picture may have at most this many texels (16384 x 8192): 1.5 GiB as RgbImage.
inline constexpr std::uint64_t kMaxImageTexels = std::uint64_t{1} << 27;

struct RgbImage {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec3> texels;  // row-major, width * height
};

struct RgbaImage {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec4> texels;  // alpha = coverage
  // Of the first surface that is not blended: distance along the view axis, not along the ray, metres;
  // infinite where there is none. width * height of them, or empty: not known.
  std::vector<float> depths = {};
};

// Pixels with less alpha than this show next to nothing but the sky: the rims of clouds, which fade for ever.
// Figures about what is in a picture leave them out. Surfaces that are not blended have 0 or 1.
inline constexpr float kLeastCoverage = 1.0f / 64.0f;

struct Rgba8Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> texels;  // 4 * width * height
};

// .hdr or .exr, told apart by the bytes, not the name. Values come as they are, NaN and infinities included.
Result<RgbImage> readLightImage(const std::filesystem::path& path);

// Alpha is 1 where the file has none; depths are its channel Z, if it has that.
Result<RgbaImage> readExr(const std::filesystem::path& path);
// Depths, where there are any, as the channel Z.
Result<void> writeExr(const std::filesystem::path& path, const RgbaImage& image);

Result<RgbImage> readHdr(const std::filesystem::path& path);
// Values below 0 or not finite cannot be coded and are an error.
Result<void> writeHdr(const std::filesystem::path& path, const RgbImage& image);

Result<Rgba8Image> readPng(const std::filesystem::path& path);
Result<void> writePng(const std::filesystem::path& path, const Rgba8Image& image);
// The PNG's bytes, for embedding.
std::vector<std::uint8_t> encodePng(const Rgba8Image& image);

}  // namespace lambent::spec
