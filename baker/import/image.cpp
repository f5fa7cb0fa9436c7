#include "baker/import/image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include "baker/import/openimageio/module.hpp"
#include "baker/import/scene_files.hpp"
#include "runtime/base/process.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/rec709.hpp"

namespace lambent::baker {

namespace {

// Returns the file that holds this code: the program, or the library that another program has loaded.
std::filesystem::path ownFile() {
  Dl_info unused;
  link_map* file = nullptr;
  const auto* code = reinterpret_cast<const void*>(&ownFile);
  std::error_code ignored;
  if (::dladdr1(code, &unused, reinterpret_cast<void**>(&file), RTLD_DL_LINKMAP) != 0 && file &&
      file->l_name[0] != '\0')
    return std::filesystem::canonical(file->l_name, ignored);
  return ownProgram().value_or(std::filesystem::path());
}

Result<const OpenImageIo*> loadModule() {
  // It lies beside the library, in ../lib of the program (in a build folder as where it is installed), or
  // where the loader looks.
  constexpr const char *kFile = "liblambent-openimageio.so", *kSymbol = "lambent_openimageio";
  const std::filesystem::path folder = ownFile().parent_path();
  std::string path = kFile;
  std::error_code ignored;
  for (const std::filesystem::path& beside : {folder / kFile, folder.parent_path() / "lib" / kFile})
    if (std::filesystem::exists(beside, ignored)) path = beside;
  void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  const char* why = module ? nullptr : ::dlerror();
  const void* symbol = module ? ::dlsym(module, kSymbol) : nullptr;
  if (!symbol)
    return fail(kFile, why ? why : "is not of this program", "install Lambent again, or build all of it");
  return static_cast<const OpenImageIo*>(symbol);
}

}  // namespace

Result<const OpenImageIo*> openImageIo() {
  static const Result<const OpenImageIo*> kModule = loadModule();
  return kModule;
}

namespace {

constexpr const char* kSaveAgain = "save it again as PNG or JPEG";

// Looks at the chunks of a PNG before it is decoded.

constexpr std::size_t kSignature = 8, kHead = 8, kChecksum = 4;  // bytes; the head is length and type
constexpr std::array<std::string_view, 5> kNeeded = {"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};

constexpr std::array<std::uint32_t, 256> crcTable() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    table[i] = i;
    for (int bit = 0; bit < 8; ++bit) table[i] = (table[i] >> 1) ^ ((table[i] & 1u) ? 0xedb88320u : 0u);
  }
  return table;
}

// Source: PNG specification, annex D.
std::uint32_t crc(std::span<const std::byte> bytes) {
  static constexpr auto kTable = crcTable();
  std::uint32_t value = ~0u;
  for (const std::byte b : bytes)
    value = kTable[(value ^ std::to_integer<std::uint32_t>(b)) & 255u] ^ (value >> 8);
  return ~value;
}

std::uint32_t u32(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = (value << 8) | std::to_integer<std::uint32_t>(bytes[at + i]);
  return value;
}

// Returns the PNG with only the chunks that its pixels need. The decoder writes its own lines to stderr about
// others (colour profiles, above all) and about wrong checksums, and leaks memory if the file ends early, so
// those are errors here. They name `subject`.
std::vector<std::byte> essentialPng(std::span<const std::byte> png, const std::string& subject) {
  const Error truncated{subject, "is truncated", "save it again"};
  if (png.size() < kSignature) throw truncated;
  std::vector<std::byte> out(png.begin(), png.begin() + kSignature);
  for (std::size_t at = kSignature; at + kHead + kChecksum <= png.size();) {
    const std::size_t length = u32(png, at);
    if (length > png.size() - at - kHead - kChecksum) throw truncated;
    const auto chunk = png.subspan(at, kHead + length + kChecksum);
    const std::string_view type(reinterpret_cast<const char*>(&chunk[4]), 4);
    if (std::ranges::find(kNeeded, type) != kNeeded.end()) {
      if (crc(chunk.subspan(4, 4 + length)) != u32(chunk, kHead + length))
        throw Error{subject, "is damaged: its " + std::string(type) + " chunk has a wrong checksum",
                    "save it again"};
      out.insert(out.end(), chunk.begin(), chunk.end());
    }
    if (type == "IEND") return out;
    at += chunk.size();
  }
  throw truncated;
}

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

glm::vec4 data(const DecodedImage& image, const gltf::Sampler& sampler, std::int64_t x, std::int64_t y) {
  const std::uint8_t* p = bytesOf(image, sampler, x, y);
  return glm::vec4(p[0], p[1], p[2], p[3]) / 255.0f;
}

// Interpolates what `read` returns of texels.
template <typename Read>
glm::vec4 sample(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv, const Read& read) {
  // Texel centres lie at half-integers. Coordinates are clamped to stay in integer range.
  const glm::dvec2 size(image.width, image.height);
  const glm::dvec2 at =
      glm::clamp(glm::dvec2(uv) * size, -1e15, 1e15) - (sampler.mag_filter == kNearest ? 0.0 : 0.5);
  const glm::dvec2 base = glm::floor(at);
  const auto x = static_cast<std::int64_t>(base.x), y = static_cast<std::int64_t>(base.y);
  if (sampler.mag_filter == kNearest) return read(image, sampler, x, y);
  const glm::vec2 f(at - base);
  return glm::mix(glm::mix(read(image, sampler, x, y), read(image, sampler, x + 1, y), f.x),
                  glm::mix(read(image, sampler, x, y + 1), read(image, sampler, x + 1, y + 1), f.x), f.y);
}

DecodedImage decode(const SceneImage& image, const std::string& subject) {
  const OpenImageIo& reader = *orThrow(openImageIo());
  std::vector<std::byte> essential;
  std::span<const std::byte> bytes = image.file_bytes;
  if (image.mime_type == "image/png") bytes = essential = essentialPng(bytes, subject);
  const std::string kind = image.mime_type.substr(image.mime_type.find('/') + 1);
  const Pixels stored = orThrow(reader.decode(bytes, "memory." + kind, subject));

  const std::size_t pixels = std::size_t{stored.width} * stored.height, channels = stored.channels;
  DecodedImage out{.width = stored.width, .height = stored.height, .rgba = {}};
  out.rgba.resize(pixels * 4);
  const bool gray = channels < 3, alpha = channels == 2 || channels >= 4;
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t* p = &stored.values[i * channels];
    for (std::size_t c = 0; c < 3; ++c) out.rgba[i * 4 + c] = gray ? p[0] : p[c];
    out.rgba[i * 4 + 3] = alpha ? p[channels == 2 ? 1 : 3] : std::uint8_t{255};
  }
  return out;
}

glm::i64vec2 texelAt(const DecodedImage& image, glm::vec2 uv) {
  return {glm::floor(glm::clamp(uv * glm::vec2(image.width, image.height), -1e15f, 1e15f))};
}

}  // namespace

Result<DecodedImage> decodeImage(const SceneImage& image) {
  const std::string subject = fmt::format("image \"{}\"", image.name);
  return resultOf(subject, "decoded", kSaveAgain, [&] { return decode(image, subject); });
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
  return sample(image, sampler, uv, texel);
}

glm::vec4 sampleData(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv) {
  return sample(image, sampler, uv, data);
}

glm::vec4 nearestTexel(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv) {
  const glm::i64vec2 at = texelAt(image, uv);
  return texel(image, sampler, at.x, at.y);
}

glm::vec4 nearestData(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv) {
  const glm::i64vec2 at = texelAt(image, uv);
  return data(image, sampler, at.x, at.y);
}

namespace {

struct Signature {
  std::string_view bytes;
  std::size_t at;
  const char* kind;
};
using namespace std::string_view_literals;
constexpr std::array kSignatures = {Signature{"\x89PNG"sv, 0, "png"}, Signature{"\xff\xd8\xff"sv, 0, "jpeg"},
                                    Signature{"WEBP"sv, 8, "webp"},   Signature{"GIF8"sv, 0, "gif"},
                                    Signature{"II*\0"sv, 0, "tiff"},  Signature{"MM\0*"sv, 0, "tiff"},
                                    Signature{"BM"sv, 0, "bmp"},      Signature{"\xabKTX"sv, 0, "ktx"}};

// Finds the kind from the first bytes, because what a file says about it is often wrong; TGA has no
// signature.
std::string kindOf(std::span<const std::byte> bytes, const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const Signature& signature : kSignatures)
    if (text.size() > 8 && text.substr(signature.at).starts_with(signature.bytes)) return signature.kind;
  const std::string ending = std::filesystem::path(name).extension().string();
  return ending == ".tga" || ending == ".TGA" ? "tga" : "";
}

SceneImage pngOf(const DecodedImage& image, std::string name) {
  bool opaque = true;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) opaque &= image.rgba[i] == 255;
  Pixels pixels{.width = image.width, .height = image.height, .channels = opaque ? 3u : 4u, .values = {}};
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    if (!opaque || i % 4 != 3) pixels.values.push_back(image.rgba[i]);
  const auto png = orThrow(orThrow(openImageIo())->encodePng(pixels, name));
  const auto bytes = std::as_bytes(std::span(png));
  return {std::move(name), "image/png", {bytes.begin(), bytes.end()}};
}

}  // namespace

SceneImage storableImage(std::string name, std::vector<std::byte> bytes) {
  const std::string kind = kindOf(bytes, name);
  if (kind == "ktx")
    throw Error{name, "is a KTX texture, which is not decoded",
                "convert the scene by: gltf-transform ktxdecompress IN.glb OUT.glb"};
  if (kind.empty()) throw Error{name, "is neither PNG, JPEG nor WebP", kSaveAgain};
  SceneImage image{std::move(name), "image/" + kind, std::move(bytes)};
  const DecodedImage decoded = orThrow(decodeImage(image));
  if (kind == "png" || kind == "jpeg") return image;
  return pngOf(decoded, std::move(image.name));
}

SceneImage roughnessImage(const SceneImage& glossiness, float factor) {
  DecodedImage image = orThrow(decodeImage(glossiness));
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const float gloss = factor * static_cast<float>(image.rgba[i + 3]);
    image.rgba[i] = image.rgba[i + 2] = 0;
    image.rgba[i + 1] = static_cast<std::uint8_t>(std::lround(255.0f - std::clamp(gloss, 0.0f, 255.0f)));
    image.rgba[i + 3] = 255;
  }
  return pngOf(image, glossiness.name + " roughness");
}

}  // namespace lambent::baker
