// Reads and writes picture files. It reads light images (.hdr Radiance RGBE or XYZE; .exr OpenEXR, scanline
// or tiled, half or float) and all that it writes: PNG (8 bits, already tone-mapped and sRGB), linear EXR
// (float32 RGBA and depths) and Radiance. Row 0 is the top. Values are linear Rec.709, to which those of
// other primaries that a file names are converted. Files are written whole or not at all. Errors name the
// file and say whether it is missing, of another type, truncated, damaged or too large. Nothing throws.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/result.hpp"

namespace lambent::spec {

// A picture may have at most this many texels (16384 x 8192), which are 1.5 GiB as RgbImage.
inline constexpr std::uint64_t kMaxImageTexels = std::uint64_t{1} << 27;

// Fails if width x height is 0, more than kMaxImageTexels, or more than `file_bytes` could hold at
// `texels_per_byte`. So a small file with a false header cannot make us reserve gigabytes.
Result<void> checkImageSize(const std::filesystem::path& path, std::uint64_t width, std::uint64_t height,
                            std::uint64_t file_bytes, std::uint64_t texels_per_byte);

struct RgbImage {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec3> texels;  // row-major, width * height
  // Sentences without a subject about what is odd in the file, and what was made of it.
  std::vector<std::string> notices = {};
};

struct RgbaImage {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec4> texels;  // alpha = coverage
  // Distance to the first surface that is not blended, along the view axis (not the ray), in metres; infinite
  // if there is none. There are width * height values, or none if depths are unknown.
  std::vector<float> depths = {};
};

// Pixels with less alpha than this show almost only sky, for example at the fading rims of clouds. Figures
// about the content of a picture ignore them. Without blended surfaces alpha is 0 or 1.
inline constexpr float kLeastCoverage = 1.0f / 64.0f;

struct Rgba8Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> texels;  // 4 * width * height
};

// Reads .hdr or .exr, which it distinguishes by the bytes, not the name. All values are radiances: negative
// ones and NaN count as 0. What is infinite or above kMostRadiance (light.hpp) counts as 65504, the largest
// half float, since it is mostly a sun that half floats could not hold.
Result<RgbImage> readLightImage(const std::filesystem::path& path);

// Values may be negative, NaN or infinite. Alpha is 1 if the file has none. Depths are the channel Z, if the
// file has it.
Result<RgbaImage> readExr(const std::filesystem::path& path);
// Writes depths, if there are any, as the channel Z. Says in the file that colours are those of Rec. 709.
Result<void> writeExr(const std::filesystem::path& path, const RgbaImage& image);

Result<RgbImage> readHdr(const std::filesystem::path& path);
// Fails if a value is negative or not finite, since the format cannot represent it.
Result<void> writeHdr(const std::filesystem::path& path, const RgbImage& image);

Result<Rgba8Image> readPng(const std::filesystem::path& path);
// Says in the file that values are sRGB.
Result<void> writePng(const std::filesystem::path& path, const Rgba8Image& image);
// Returns the bytes of the PNG, for embedding in scenes, where its use says what values are.
std::vector<std::uint8_t> encodePng(const Rgba8Image& image);

// Returns what lambent-demo shows at --exposure 0: the same tone curve (runtime/tone_map/tone_curve.glsl),
// then sRGB. The picture is opaque.
Rgba8Image displayed(const RgbaImage& linear);

}  // namespace lambent::spec
