#include "runtime/spec/image.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <limits>
#include <optional>

#include <Imath/ImathBox.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticities.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "runtime/base/atomic_file.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/spec/rec709.hpp"

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

namespace {

// The names and the order of terms are those of tone_curve.glsl.
glm::vec3 toneCurve(glm::vec3 linear) {
  constexpr float kStart = 0.8f - 0.04f, kDesaturation = 0.15f;
  const float low = std::min({linear.r, linear.g, linear.b});
  glm::vec3 mapped = linear - (low < 0.08f ? low - 6.25f * low * low : 0.04f);
  const float peak = std::max({mapped.r, mapped.g, mapped.b});
  if (peak < kStart) return mapped;
  constexpr float kRange = 1.0f - kStart;
  const float new_peak = 1.0f - kRange * kRange / (peak + kRange - kStart);
  mapped *= new_peak / peak;
  const float to_white = 1.0f - 1.0f / (kDesaturation * (peak - new_peak) + 1.0f);
  return glm::mix(mapped, glm::vec3(new_peak), to_white);
}

float srgbFromLinear(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

}  // namespace

Rgba8Image displayed(const RgbaImage& linear) {
  Rgba8Image out{linear.width, linear.height, {}};
  out.texels.reserve(4 * linear.texels.size());
  for (const glm::vec4& texel : linear.texels) {
    const glm::vec3 shown = toneCurve(glm::clamp(glm::vec3(texel), glm::vec3(0.0f), glm::vec3(kLargestHalf)));
    for (int c = 0; c < 3; ++c)
      out.texels.push_back(
          static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(srgbFromLinear(shown[c]), 0.0f, 1.0f))));
    out.texels.push_back(255);
  }
  return out;
}

// OpenEXR. The library throws, but this file catches all its exceptions.

namespace {

// Standard name of OpenEXR for depth.
constexpr char kDepthChannel[] = "Z";

// A file in memory, so that the file on disk can be written whole or not at all.
class MemoryStream : public Imf::OStream {
 public:
  MemoryStream() : Imf::OStream("memory") {}
  void write(const char bytes[], int count) override {
    const std::size_t size = static_cast<std::size_t>(count);
    if (at_ + size > bytes_.size()) bytes_.resize(at_ + size);
    std::memcpy(bytes_.data() + at_, bytes, size);
    at_ += size;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

std::uint64_t extent(int low, int high) {
  return high < low ? 0 : static_cast<std::uint64_t>(std::int64_t{high} - low + 1);
}

std::string channelNames(const Imf::ChannelList& channels) {
  std::string names;
  for (auto it = channels.begin(); it != channels.end(); ++it)
    names += (names.empty() ? "" : ", ") + std::string(it.name());
  return names.empty() ? "none" : names;
}

bool isWholeChannel(const Imf::ChannelList& channels, const char* name) {
  const Imf::Channel* channel = channels.findChannel(name);
  return channel && channel->xSampling == 1 && channel->ySampling == 1;
}

// Copies values from the data window to the display window, which is the picture. The data window may be
// smaller or larger.
template <typename Value>
std::vector<Value> toDisplayWindow(std::vector<Value> data, const Imath::Box2i& from, const Imath::Box2i& to,
                                   const Value& outside) {
  if (from == to) return data;
  const std::size_t data_width = extent(from.min.x, from.max.x), width = extent(to.min.x, to.max.x);
  std::vector<Value> values(width * extent(to.min.y, to.max.y), outside);
  for (int y = std::max(from.min.y, to.min.y); y <= std::min(from.max.y, to.max.y); ++y)
    for (int x = std::max(from.min.x, to.min.x); x <= std::min(from.max.x, to.max.x); ++x)
      values[static_cast<std::size_t>(y - to.min.y) * width + static_cast<std::size_t>(x - to.min.x)] =
          data[static_cast<std::size_t>(y - from.min.y) * data_width +
               static_cast<std::size_t>(x - from.min.x)];
  return values;
}

bool hasColors(const Imf::ChannelList& channels) {
  return isWholeChannel(channels, "R") && isWholeChannel(channels, "G") && isWholeChannel(channels, "B");
}

// Chroma (RY, BY) comes at half the resolution, so that such pictures are not grey.
bool isGrey(const Imf::ChannelList& channels) {
  return isWholeChannel(channels, "Y") && !channels.findChannel("RY");
}

// Returns the first part that holds a picture. Depth and masks may come before it.
Result<int> pictureIn(const Imf::MultiPartInputFile& file, const std::filesystem::path& path) {
  std::string names;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    const bool deep = header.hasType() && Imf::isDeepData(header.type());
    if (!deep && (hasColors(header.channels()) || isGrey(header.channels()))) return part;
    names += (names.empty() ? "" : "; ") + std::string(deep ? "deep " : "") + channelNames(header.channels());
  }
  return fail(path.string(), "has no channels R, G and B (it has " + names + ")",
              "save it as RGB at full resolution, one sample per pixel");
}

// Attributes whiteLuminance and expTime are of no use here: both say how bright the place was, and only the
// ratio between the lights of a scene matters, which would change between a file that says so and one that
// does not.
std::optional<glm::mat3> rec709From(const Imf::Header& header) {
  if (!Imf::hasChromaticities(header)) return glm::mat3(1.0f);  // the format's default is Rec. 709
  const Imf::Chromaticities& said = Imf::chromaticities(header);
  const auto xy = [](const Imath::V2f& from) { return glm::dvec2(from.x, from.y); };
  return rec709From(Primaries{xy(said.red), xy(said.green), xy(said.blue), xy(said.white)});
}

// An OpenEXR picture in the colours of its file.
struct CodedExr {
  RgbaImage image;
  std::optional<glm::mat3> rec709_from_file;  // nothing if the primaries that it names span no colours
};

Result<CodedExr> readOpened(Imf::MultiPartInputFile& file, const std::filesystem::path& path,
                            std::uint64_t file_bytes) {
  const Result<int> part = pictureIn(file, path);
  if (!part) return failAgain(part.error());
  const Imf::Header& header = file.header(*part);
  const Imath::Box2i data = header.dataWindow(), display = header.displayWindow();
  constexpr std::uint64_t kTexelsPerByte = 4096;  // far more than any compression of OpenEXR reaches
  for (const Imath::Box2i& window : {data, display})
    if (const auto checked = checkImageSize(path, extent(window.min.x, window.max.x),
                                            extent(window.min.y, window.max.y), file_bytes, kTexelsPerByte);
        !checked)
      return failAgain(checked.error());
  if (!data.intersects(display))
    return fail(path.string(), "shows none of its texels: its data window lies outside its display window",
                "save it without a crop");

  const Imf::ChannelList& channels = header.channels();
  const bool rgb = hasColors(channels);
  const std::size_t count = extent(data.min.x, data.max.x) * extent(data.min.y, data.max.y);
  std::vector<glm::vec4> texels(count);
  std::vector<float> depths(isWholeChannel(channels, kDepthChannel) ? count : 0);
  Imf::FrameBuffer target;
  const auto slice = [&](const char* name, float* values, std::size_t stride, double where_missing) {
    target.insert(name, Imf::Slice::Make(Imf::FLOAT, values, data, stride, 0, 1, 1, where_missing));
  };
  const auto color = [&](const char* name, int component, double where_missing) {
    slice(name, reinterpret_cast<float*>(texels.data()) + component, sizeof(glm::vec4), where_missing);
  };
  if (rgb) {
    color("R", 0, 0.0);
    color("G", 1, 0.0);
    color("B", 2, 0.0);
  } else {
    color("Y", 0, 0.0);
  }
  color("A", 3, 1.0);
  if (!depths.empty()) slice(kDepthChannel, depths.data(), sizeof(float), 0.0);
  Imf::InputPart picture(file, *part);
  picture.setFrameBuffer(target);
  picture.readPixels(data.min.y, data.max.y);
  if (!rgb)
    for (glm::vec4& texel : texels) texel.y = texel.z = texel.x;
  RgbaImage image{.width = static_cast<std::uint32_t>(extent(display.min.x, display.max.x)),
                  .height = static_cast<std::uint32_t>(extent(display.min.y, display.max.y)),
                  .texels = toDisplayWindow(std::move(texels), data, display, glm::vec4(0.0f))};
  if (!depths.empty())
    image.depths = toDisplayWindow(std::move(depths), data, display, std::numeric_limits<float>::infinity());
  return CodedExr{std::move(image), rec709From(header)};
}

Result<CodedExr> readCodedExr(const std::filesystem::path& path) {
  if (auto checked = checkRegularFile(path, "an .exr file"); !checked) return failAgain(checked.error());
  std::error_code code;
  const std::uint64_t file_bytes = std::filesystem::file_size(path, code);
  if (code) return fail(path.string(), "cannot be read", "check its permissions");
  try {
    Imf::MultiPartInputFile file(path.c_str(), /*numThreads=*/0);
    return readOpened(file, path, file_bytes);
  } catch (const std::exception& error) {
    std::string what = error.what();
    if (const std::size_t newline = what.find('\n'); newline != std::string::npos) what.resize(newline);
    return fail(path.string(), "is not a readable OpenEXR picture: " + what,
                "copy, download or export it again");
  }
}

}  // namespace

Result<RgbaImage> readExr(const std::filesystem::path& path) {
  Result<CodedExr> coded = readCodedExr(path);
  if (!coded) return failAgain(std::move(coded.error()));
  const glm::mat3 matrix = coded->rec709_from_file.value_or(glm::mat3(1.0f));
  if (matrix != glm::mat3(1.0f))
    for (glm::vec4& texel : coded->image.texels) texel = glm::vec4(matrix * glm::vec3(texel), texel.a);
  return std::move(coded->image);
}

Result<void> writeExr(const std::filesystem::path& path, const RgbaImage& image) {
  assert(image.depths.empty() || image.depths.size() == image.texels.size());
  MemoryStream stream;
  try {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities());  // by default those of Rec. 709
    Imf::FrameBuffer source;
    const Imath::Box2i window = header.dataWindow();
    for (int component = 0; component < 4; ++component) {
      const char name[] = {"RGBA"[component], '\0'};
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      const float* base = reinterpret_cast<const float*>(image.texels.data()) + component;
      source.insert(name, Imf::Slice::Make(Imf::FLOAT, base, window, sizeof(glm::vec4)));
    }
    if (!image.depths.empty()) {
      header.channels().insert(kDepthChannel, Imf::Channel(Imf::FLOAT));
      source.insert(kDepthChannel, Imf::Slice::Make(Imf::FLOAT, image.depths.data(), window, sizeof(float)));
    }
    Imf::OutputFile file(stream, header, /*numThreads=*/0);
    file.setFrameBuffer(source);
    file.writePixels(static_cast<int>(image.height));
  } catch (const std::exception& error) {
    return fail(path.string(), std::string("cannot be coded: ") + error.what());
  }
  return writeFile(path, std::as_bytes(std::span(stream.bytes())));
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
