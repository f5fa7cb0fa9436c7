#include "baker/import/material_textures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/error_text.hpp"
#include "baker/import/image.hpp"
#include "baker/import/openimageio/module.hpp"
#include "baker/import/scene.hpp"
#include "baker/import/scene_files.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

namespace {

// Makes images that bundles can keep: PNG or JPEG, whatever the file brings.

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

// Returns a PNG or JPEG as it is, and WebP, BMP, GIF, TIFF and TGA as PNG. Errors: the image is of
// another kind, or cannot be decoded.
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

// Returns the metallic-roughness texture of KHR_materials_pbrSpecularGlossiness, whose images have glossiness
// in alpha: green is 1 - factor x glossiness, blue is 0.
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

glm::vec2 pairOr(const tinygltf::Value& object, const char* key, glm::vec2 fallback) {
  if (!object.Has(key)) return fallback;
  const tinygltf::Value& pair = object.Get(key);
  if (!pair.IsArray() || pair.ArrayLen() != 2 || !pair.Get(0).IsNumber() || !pair.Get(1).IsNumber())
    return fallback;
  return {static_cast<float>(pair.Get(0).GetNumberAsDouble()),
          static_cast<float>(pair.Get(1).GetNumberAsDouble())};
}

// Returns a textureInfo without its texture: the coordinate set and KHR_texture_transform.
gltf::TextureRef placementOf(const tinygltf::ExtensionMap& extensions, int texcoord) {
  gltf::TextureRef ref;
  ref.texcoord = static_cast<std::uint32_t>(std::max(texcoord, 0));
  const auto extension = extensions.find("KHR_texture_transform");
  if (extension == extensions.end() || !extension->second.IsObject()) return ref;
  const tinygltf::Value& value = extension->second;
  ref.offset = pairOr(value, "offset", ref.offset);
  ref.scale = pairOr(value, "scale", ref.scale);
  ref.rotation_rad = numberOr(value, "rotation", 0.0f);
  const float overriding = numberOr(value, "texCoord", static_cast<float>(ref.texcoord));
  ref.texcoord = static_cast<std::uint32_t>(std::clamp(overriding, 0.0f, 255.0f));
  return ref;
}

// Returns the images that a texture names, its own one first, then those for readers of an extension.
std::vector<std::size_t> imagesOf(const nlohmann::json& texture, std::size_t count) {
  std::vector<std::size_t> images;
  const auto add = [&](const nlohmann::json& owner) {
    if (!owner.is_object() || !owner.contains("source")) return;
    const nlohmann::json& source = owner["source"];
    if (source.is_number_unsigned() && source.get<std::size_t>() < count)
      images.push_back(source.get<std::size_t>());
  };
  add(texture);
  if (texture.contains("extensions"))
    for (const nlohmann::json& extension : texture["extensions"]) add(extension);
  return images;
}

}  // namespace

float numberOr(const tinygltf::Value& object, const char* key, float fallback) {
  return object.Has(key) && object.Get(key).IsNumber()
             ? static_cast<float>(object.Get(key).GetNumberAsDouble())
             : fallback;
}

MaterialTextures::MaterialTextures(const Document& document, Scene& scene)
    : document_(document),
      scene_(scene),
      texture_of_(document.model().textures.size(), kUnknown),
      image_of_(document.json().contains("images") ? document.json()["images"].size() : 0, kUnknown) {}

gltf::TextureRef MaterialTextures::refer(int index, const tinygltf::ExtensionMap& extensions, int texcoord,
                                         std::size_t material, const char* use) {
  if (index < 0) return gltf::TextureRef{};
  gltf::TextureRef ref = placementOf(extensions, texcoord);
  if (ref.texcoord > 1) {
    scene_.warnings.push_back(
        fmt::format("material {}: its {} uses TEXCOORD_{}: only 0 and 1 are read, it is left out", material,
                    use, ref.texcoord));
    return gltf::TextureRef{};
  }
  ref.texture = take(index);
  return ref.texture < 0 ? gltf::TextureRef{} : ref;
}

gltf::TextureRef MaterialTextures::refer(const tinygltf::Value& extension, const char* key,
                                         std::size_t material, const char* use) {
  if (!extension.Has(key)) return gltf::TextureRef{};
  const tinygltf::Value& info = extension.Get(key);
  tinygltf::ExtensionMap extensions;
  if (info.Has("extensions")) extensions = info.Get("extensions").Get<tinygltf::Value::Object>();
  const int texcoord = info.Has("texCoord") ? info.Get("texCoord").GetNumberAsInt() : 0;
  return refer(info.Get("index").GetNumberAsInt(), extensions, texcoord, material, use);
}

gltf::TextureRef MaterialTextures::roughnessOf(gltf::TextureRef ref, float factor) {
  if (ref.texture < 0) return ref;
  const auto [known, added] = roughness_of_.try_emplace({ref.texture, factor}, -1);
  if (added) {
    gltf::Texture texture = scene_.textures[static_cast<std::size_t>(ref.texture)];
    auto roughness = roughnessImage(scene_.images[static_cast<std::size_t>(texture.image)], factor);
    if (roughness) {
      texture.image = static_cast<std::int32_t>(scene_.images.size());
      scene_.images.push_back(std::move(*roughness));
      known->second = static_cast<std::int32_t>(scene_.textures.size());
      scene_.textures.push_back(texture);
    } else {
      scene_.warnings.push_back(roughness.error().line());
    }
  }
  ref.texture = known->second;
  return ref;
}

std::int32_t MaterialTextures::take(int index) {
  std::int32_t& texture = texture_of_[static_cast<std::size_t>(index)];
  if (texture != kUnknown) return texture;
  texture = -1;
  const auto images =
      imagesOf(document_.json()["textures"][static_cast<std::size_t>(index)], image_of_.size());
  if (images.empty())
    scene_.warnings.push_back(fmt::format("texture {} names no image and is left out", index));
  gltf::Texture out;
  for (const std::size_t image : images)
    if (out.image < 0) out.image = takeImage(image);
  if (out.image < 0) return texture;
  const tinygltf::Texture& source = document_.model().textures[static_cast<std::size_t>(index)];
  if (source.sampler >= 0) {
    const tinygltf::Sampler& sampler = document_.model().samplers[static_cast<std::size_t>(source.sampler)];
    out.sampler.wrap_s = static_cast<std::uint32_t>(sampler.wrapS);
    out.sampler.wrap_t = static_cast<std::uint32_t>(sampler.wrapT);
    if (sampler.magFilter > 0) out.sampler.mag_filter = static_cast<std::uint32_t>(sampler.magFilter);
    if (sampler.minFilter > 0) out.sampler.min_filter = static_cast<std::uint32_t>(sampler.minFilter);
  }
  texture = static_cast<std::int32_t>(scene_.textures.size());
  scene_.textures.push_back(out);
  return texture;
}

std::int32_t MaterialTextures::takeImage(std::size_t index) {
  std::int32_t& image = image_of_[index];
  if (image != kUnknown) return image;
  image = -1;
  auto read = readImage(index);
  if (read) {
    image = static_cast<std::int32_t>(scene_.images.size());
    scene_.images.push_back(std::move(*read));
  } else {
    lacks_images_ = true;
    const Error& error = read.error();
    const std::string uri = document_.json()["images"][index].value("uri", "");
    scene_.warnings.push_back(fmt::format(
        "image {}{}: {}, so surfaces look as without it ({})", index,
        uri.empty() || uri.starts_with("data:") ? "" : fmt::format(" (\"{}\")", uri.substr(0, 80)),
        error.problem, error.hint));
  }
  return image;
}

Result<SceneImage> MaterialTextures::readImage(std::size_t index) {
  const std::string object = fmt::format("image {}", index);
  const nlohmann::json& source = document_.json()["images"][index];
  auto bytes = imageBytes(source, object);
  if (!bytes) return failAgain(std::move(bytes.error()));
  std::string name = source.value("name", "");
  const std::string uri = source.value("uri", "");
  if (name.empty() && source.contains("uri") && !uri.starts_with("data:")) name = decodePercent(uri);
  return storableImage(std::move(name), std::move(*bytes));
}

Result<std::vector<std::byte>> MaterialTextures::imageBytes(const nlohmann::json& source,
                                                            const std::string& object) {
  if (source.contains("uri"))
    return readUri(document_.path(), source["uri"].get<std::string>(), document_.options(), object,
                   scene_.warnings);
  if (!source.contains("bufferView"))
    return fail(object, "names neither a file nor a bufferView", "name a file");
  const tinygltf::BufferView& view = document_.model().bufferViews[source["bufferView"].get<std::size_t>()];
  const auto bytes =
      std::as_bytes(std::span(document_.model().buffers[static_cast<std::size_t>(view.buffer)].data))
          .subspan(view.byteOffset, view.byteLength);
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

}  // namespace lambent::baker
