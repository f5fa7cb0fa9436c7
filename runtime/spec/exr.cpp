// Reads and writes OpenEXR. The library throws, but this file catches all its exceptions.
#include <algorithm>
#include <cassert>
#include <cstring>
#include <exception>
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

#include "runtime/spec/file_bytes.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/rec709.hpp"

namespace lambent::spec {

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

}  // namespace

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
  return writeWholeFile(path, std::as_bytes(std::span(stream.bytes())));
}

}  // namespace lambent::spec
