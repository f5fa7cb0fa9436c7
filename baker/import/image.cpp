#include "baker/import/image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <span>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "baker/import/png_chunks.hpp"
#include "baker/import/reason.hpp"
#include "runtime/spec/rec709.hpp"

namespace lambent::baker {
namespace {

constexpr int kLargestSide = 1 << 15;
constexpr std::uint32_t kClampToEdge = 33071, kMirroredRepeat = 33648, kNearest = 9728;

const std::array<float, 256>& srgbTable() {
  static const std::array<float, 256> kTable = [] {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i)
      table[i] = spec::linearFromSrgb(static_cast<float>(i) / 255.0f);
    return table;
  }();
  return kTable;
}

std::uint32_t wrap(std::int64_t texel, std::uint32_t size, std::uint32_t mode) {
  const auto n = static_cast<std::int64_t>(size);
  if (texel >= 0 && texel < n)
    return static_cast<std::uint32_t>(texel);  // the common case first, since divisions are slow
  if (mode == kClampToEdge) return static_cast<std::uint32_t>(std::clamp<std::int64_t>(texel, 0, n - 1));
  const std::int64_t period = mode == kMirroredRepeat ? 2 * n : n;
  std::int64_t t = texel % period;
  if (t < 0) t += period;
  return static_cast<std::uint32_t>(t < n ? t : period - 1 - t);
}

const std::uint8_t* bytesOf(const DecodedImage& image, const gltf::Sampler& sampler, std::int64_t x,
                            std::int64_t y) {
  const std::size_t column = wrap(x, image.width, sampler.wrap_s),
                    row = wrap(y, image.height, sampler.wrap_t);
  return &image.rgba[(row * image.width + column) * 4];
}

glm::vec4 texel(const DecodedImage& image, const gltf::Sampler& sampler, std::int64_t x, std::int64_t y) {
  const std::uint8_t* p = bytesOf(image, sampler, x, y);
  return {srgbTable()[p[0]], srgbTable()[p[1]], srgbTable()[p[2]], static_cast<float>(p[3]) / 255.0f};
}

Result<DecodedImage> decode(const SceneImage& image) {
  const std::string subject = fmt::format("image \"{}\"", image.name);
  std::vector<std::byte> essential;
  std::span<const std::byte> bytes = image.file_bytes;
  if (image.mime_type == "image/png") {
    auto png = essentialPng(bytes, subject);
    if (!png) return failAgain(png.error());
    essential = std::move(*png);
    bytes = essential;
  }
  OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(bytes.data()), bytes.size());
  OIIO::ImageSpec wanted;
  wanted.attribute("oiio:UnassociatedAlpha", 1);  // glTF colours are not premultiplied by alpha
  const char* name = image.mime_type == "image/png" ? "memory.png" : "memory.jpg";
  // The reader takes its bytes from the configuration, because open() forgets the proxy if it gets both.
  OIIO::Filesystem::IOProxy* proxy = &memory;
  wanted.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const auto input = OIIO::ImageInput::open(name, &wanted);
  if (!input)
    return fail(subject, fmt::format("cannot be decoded ({})", OIIO::geterror()),
                "save it again as PNG or JPEG");

  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width <= 0 || spec.height <= 0 || spec.width > kLargestSide || spec.height > kLargestSide ||
      spec.nchannels < 1)
    return fail(subject, fmt::format("has {} x {} pixels", spec.width, spec.height),
                "save it again in a usual size");
  const auto width = static_cast<std::size_t>(spec.width), height = static_cast<std::size_t>(spec.height);
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  std::vector<std::uint8_t> stored(width * height * channels);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, stored.data()))
    return fail(subject, fmt::format("is damaged ({})", input->geterror()), "save it again");

  DecodedImage out{
      .width = static_cast<std::uint32_t>(width), .height = static_cast<std::uint32_t>(height), .rgba = {}};
  out.rgba.resize(width * height * 4);
  const bool gray = channels < 3, alpha = channels == 2 || channels >= 4;
  for (std::size_t i = 0; i < width * height; ++i) {
    const std::uint8_t* p = &stored[i * channels];
    for (std::size_t c = 0; c < 3; ++c) out.rgba[i * 4 + c] = gray ? p[0] : p[c];
    out.rgba[i * 4 + 3] = alpha ? p[channels == 2 ? 1 : 3] : std::uint8_t{255};
  }
  return out;
}

}  // namespace

Result<DecodedImage> decodeImage(const SceneImage& image) {
  try {
    return decode(image);
  } catch (const std::exception& exception) {
    return fail(fmt::format("image \"{}\"", image.name),
                fmt::format("cannot be decoded ({})", reasonOf(exception)), "save it again as PNG or JPEG");
  }
}

Result<std::shared_ptr<const DecodedImage>> DecodedImages::ofTexture(std::int32_t texture) {
  if (texture < 0) return std::shared_ptr<const DecodedImage>();
  const std::int32_t index = scene_.textures[static_cast<std::size_t>(texture)].image;
  if (index < 0) return std::shared_ptr<const DecodedImage>();
  auto& image = images_[index];
  if (!image) {
    auto pixels = decodeImage(scene_.images[static_cast<std::size_t>(index)]);
    if (!pixels) return failAgain(pixels.error());
    image = std::make_shared<DecodedImage>(std::move(*pixels));
  }
  return image;
}

glm::vec4 sampleImage(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv) {
  // Texel centres lie at half-integers. Coordinates are clamped to stay in integer range.
  const glm::dvec2 size(image.width, image.height);
  const glm::dvec2 at =
      glm::clamp(glm::dvec2(uv) * size, -1e15, 1e15) - (sampler.mag_filter == kNearest ? 0.0 : 0.5);
  const glm::dvec2 base = glm::floor(at);
  const auto x = static_cast<std::int64_t>(base.x), y = static_cast<std::int64_t>(base.y);
  if (sampler.mag_filter == kNearest) return texel(image, sampler, x, y);
  const glm::vec2 f(at - base);
  return glm::mix(glm::mix(texel(image, sampler, x, y), texel(image, sampler, x + 1, y), f.x),
                  glm::mix(texel(image, sampler, x, y + 1), texel(image, sampler, x + 1, y + 1), f.x), f.y);
}

namespace {

glm::vec2 texelPlace(const DecodedImage& image, glm::vec2 uv) {
  return glm::floor(glm::clamp(uv * glm::vec2(image.width, image.height), -1e15f, 1e15f));
}

}  // namespace

glm::vec4 nearestTexel(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv) {
  const glm::vec2 at = texelPlace(image, uv);
  return texel(image, sampler, static_cast<std::int64_t>(at.x), static_cast<std::int64_t>(at.y));
}

glm::vec4 nearestData(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv) {
  const glm::vec2 at = texelPlace(image, uv);
  const std::uint8_t* p =
      bytesOf(image, sampler, static_cast<std::int64_t>(at.x), static_cast<std::int64_t>(at.y));
  return glm::vec4(p[0], p[1], p[2], p[3]) / 255.0f;
}

}  // namespace lambent::baker
