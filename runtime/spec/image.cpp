#include "runtime/spec/image.hpp"

#include <fstream>

#include "runtime/spec/file_bytes.hpp"

namespace lambent::spec {

Result<void> checkImageSize(const std::filesystem::path& path, std::uint64_t width, std::uint64_t height,
                            std::uint64_t file_bytes, std::uint64_t texels_per_byte) {
  const std::string size = std::to_string(width) + " x " + std::to_string(height);
  if (width == 0 || height == 0) return fail(path.string(), "has no texels (" + size + ")", "check the file");
  if (width > kMaxImageTexels || height > kMaxImageTexels || width * height > kMaxImageTexels)
    return fail(path.string(), "is too large (" + size + ")", "scale it down to at most 16384 x 8192");
  if (width * height > file_bytes * texels_per_byte)
    return fail(path.string(), "is truncated or damaged: its header promises " + size + " texels",
                "copy or download it again");
  return {};
}

Result<RgbImage> readLightImage(const std::filesystem::path& path) {
  constexpr std::string_view kExrMagic = "\x76\x2f\x31\x01", kHdrMagic = "#?";
  if (auto checked = checkRegularFile(path, "a .hdr or .exr file"); !checked)
    return failAgain(checked.error());
  std::string head(kExrMagic.size(), '\0');
  std::ifstream in(path, std::ios::binary);
  if (!in) return fail(path.string(), "cannot be read", "check its permissions");
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  if (head.empty()) return fail(path.string(), "is empty", "copy or download it again");
  if (head.starts_with(kHdrMagic)) return readHdr(path);
  if (head != kExrMagic)
    return fail(path.string(), "is neither Radiance (.hdr) nor OpenEXR (.exr)",
                "convert it to one of the two");
  Result<RgbaImage> exr = readExr(path);
  if (!exr) return failAgain(std::move(exr.error()));
  RgbImage image{exr->width, exr->height, {}};
  image.texels.assign(exr->texels.begin(), exr->texels.end());  // drops alpha
  return image;
}

}  // namespace lambent::spec
