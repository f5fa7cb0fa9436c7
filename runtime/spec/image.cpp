#include "runtime/spec/image.hpp"

#include <fstream>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "runtime/spec/file_bytes.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::spec {

namespace {

constexpr float kLargestHalf = 65504.0f;

glm::vec3 limited(glm::vec3 color) {
  for (int channel = 0; channel < 3; ++channel) {
    float& value = color[channel];
    value = value > kMostRadiance ? kLargestHalf : value >= -kMostRadiance ? value : 0.0f;  // NaN counts as 0
  }
  return color;
}

// Makes radiances of what a file holds. Values are limited before colours are converted, since an infinite
// channel would make NaN of the others, and afterwards too.
void toRadiances(RgbImage& image, const glm::mat3& rec709_from_file) {
  std::uint64_t too_bright = 0, no_light = 0;
  for (glm::vec3& texel : image.texels) {
    const glm::vec3 stored = texel, converted = limited(rec709_from_file * limited(stored));
    texel = glm::max(converted, glm::vec3(0.0f));  // filters that sharpen leave some values below 0
    too_bright += glm::any(glm::greaterThan(stored, glm::vec3(kMostRadiance)));
    no_light += !glm::all(glm::greaterThanEqual(stored, glm::vec3(-kMostRadiance))) || texel != converted;
  }
  const auto notice = [&](const char* what, std::uint64_t texels, const char* counts_as) {
    if (texels > 0)
      image.notices.push_back(std::string("is ") + what + " in " + std::to_string(texels) + " of " +
                              std::to_string(image.texels.size()) + " texels, which count as " + counts_as);
  };
  notice("negative or no number", no_light, "0");
  notice("infinite or above 1e15", too_bright, "65504");
}

}  // namespace

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
  if (head.starts_with(kHdrMagic)) {
    Result<RgbImage> hdr = readHdr(path);
    if (hdr) toRadiances(*hdr, glm::mat3(1.0f));
    return hdr;
  }
  if (head != kExrMagic)
    return fail(path.string(), "is neither Radiance (.hdr) nor OpenEXR (.exr)",
                "convert it to one of the two");
  const Result<CodedExr> exr = readCodedExr(path);
  if (!exr) return failAgain(exr.error());
  RgbImage image{exr->image.width, exr->image.height, {}};
  image.texels.assign(exr->image.texels.begin(), exr->image.texels.end());  // drops alpha
  if (!exr->rec709_from_file)
    image.notices.push_back("names primaries that span no colours, so that those of Rec. 709 are assumed");
  toRadiances(image, exr->rec709_from_file.value_or(glm::mat3(1.0f)));
  return image;
}

}  // namespace lambent::spec
