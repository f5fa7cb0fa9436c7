#include "baker/import/storable_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <filesystem>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "baker/import/image.hpp"
#include "baker/import/openimageio/module.hpp"
#include "baker/import/reason.hpp"

namespace lambent::baker {
namespace {

constexpr const char* kSaveAgain = "save it again as PNG or JPEG";

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

Result<SceneImage> pngOf(const DecodedImage& image, std::string name) {
  const auto writer = openImageIo();
  if (!writer) return failAgain(writer.error());
  bool opaque = true;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) opaque &= image.rgba[i] == 255;
  Pixels pixels{.width = image.width, .height = image.height, .channels = opaque ? 3u : 4u, .values = {}};
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    if (!opaque || i % 4 != 3) pixels.values.push_back(image.rgba[i]);
  const auto png = (*writer)->encodePng(pixels, name);
  if (!png) return failAgain(png.error());
  const auto bytes = std::as_bytes(std::span(*png));
  return SceneImage{std::move(name), "image/png", {bytes.begin(), bytes.end()}};
}

}  // namespace

Result<SceneImage> storableImage(std::string name, std::vector<std::byte> bytes) {
  const std::string kind = kindOf(bytes, name);
  if (kind == "ktx")
    return fail(name, "is a KTX texture, which is not decoded",
                "convert the scene by: gltf-transform ktxdecompress IN.glb OUT.glb");
  if (kind.empty()) return fail(name, "is neither PNG, JPEG nor WebP", kSaveAgain);
  SceneImage image{std::move(name), "image/" + kind, std::move(bytes)};
  const auto decoded = decodeImage(image);
  if (!decoded) return failAgain(decoded.error());
  if (kind == "png" || kind == "jpeg") return image;
  return pngOf(*decoded, std::move(image.name));
}

Result<SceneImage> roughnessImage(const SceneImage& glossiness, float factor) {
  auto image = decodeImage(glossiness);
  if (!image) return failAgain(image.error());
  for (std::size_t i = 0; i < image->rgba.size(); i += 4) {
    const float gloss = factor * static_cast<float>(image->rgba[i + 3]);
    image->rgba[i] = image->rgba[i + 2] = 0;
    image->rgba[i + 1] = static_cast<std::uint8_t>(std::lround(255.0f - std::clamp(gloss, 0.0f, 255.0f)));
    image->rgba[i + 3] = 255;
  }
  return pngOf(*image, glossiness.name + " roughness");
}

}  // namespace lambent::baker
