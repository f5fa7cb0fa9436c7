#include "baker/import/material_textures.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/uri.hpp"

namespace lambent::baker {
namespace {

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

// Finds the type from the first bytes, because what the file says about it is often wrong.
std::string imageType(const std::vector<std::byte>& bytes) {
  constexpr std::array<unsigned char, 4> kPng{0x89, 'P', 'N', 'G'};
  constexpr std::array<unsigned char, 3> kJpeg{0xff, 0xd8, 0xff};
  if (bytes.size() > 8 && std::memcmp(bytes.data(), kPng.data(), kPng.size()) == 0) return "image/png";
  if (bytes.size() > 8 && std::memcmp(bytes.data(), kJpeg.data(), kJpeg.size()) == 0) return "image/jpeg";
  return {};
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

Result<gltf::TextureRef> MaterialTextures::refer(int index, const tinygltf::ExtensionMap& extensions,
                                                 int texcoord, std::size_t material, const char* use) {
  if (index < 0) return gltf::TextureRef{};
  gltf::TextureRef ref = placementOf(extensions, texcoord);
  if (ref.texcoord > 1) {
    scene_.warnings.push_back(
        fmt::format("material {}: its {} uses TEXCOORD_{}: only 0 and 1 are read, it is left out", material,
                    use, ref.texcoord));
    return gltf::TextureRef{};
  }
  const auto texture = take(index);
  if (!texture) return failAgain(texture.error());
  ref.texture = *texture;
  return ref.texture < 0 ? gltf::TextureRef{} : ref;
}

Result<gltf::TextureRef> MaterialTextures::refer(const tinygltf::Value& extension, const char* key,
                                                 std::size_t material, const char* use) {
  if (!extension.Has(key)) return gltf::TextureRef{};
  const tinygltf::Value& info = extension.Get(key);
  tinygltf::ExtensionMap extensions;
  if (info.Has("extensions")) extensions = info.Get("extensions").Get<tinygltf::Value::Object>();
  const int texcoord = info.Has("texCoord") ? info.Get("texCoord").GetNumberAsInt() : 0;
  return refer(info.Get("index").GetNumberAsInt(), extensions, texcoord, material, use);
}

Result<std::int32_t> MaterialTextures::take(int index) {
  std::int32_t& texture = texture_of_[static_cast<std::size_t>(index)];
  if (texture != kUnknown) return texture;
  const tinygltf::Texture& source = document_.model().textures[static_cast<std::size_t>(index)];
  texture = -1;
  if (source.source < 0) {
    scene_.warnings.push_back(fmt::format("texture {} has no PNG or JPEG image and is left out", index));
    return texture;
  }
  auto image = takeImage(source.source);
  if (!image) return failAgain(std::move(image.error()));
  if (*image < 0) return texture;
  gltf::Texture out;
  out.image = *image;
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

Result<std::int32_t> MaterialTextures::takeImage(int index) {
  std::int32_t& image = image_of_[static_cast<std::size_t>(index)];
  if (image != kUnknown) return image;
  const nlohmann::json& source = document_.json()["images"][static_cast<std::size_t>(index)];
  auto bytes = imageBytes(source, index);
  if (!bytes) return failAgain(std::move(bytes.error()));
  image = -1;
  const std::string type = imageType(*bytes);
  if (type.empty()) {
    scene_.warnings.push_back(fmt::format("image {} is neither PNG nor JPEG and is left out", index));
    return image;
  }
  image = static_cast<std::int32_t>(scene_.images.size());
  std::string name = source.value("name", "");
  const std::string uri = source.value("uri", "");
  if (name.empty() && !uri.starts_with("data:")) name = decodePercent(uri);
  scene_.images.push_back({name, type, std::move(*bytes)});
  return image;
}

Result<std::vector<std::byte>> MaterialTextures::imageBytes(const nlohmann::json& source, int index) const {
  if (source.contains("uri"))
    return readUri(document_.path(), source["uri"].get<std::string>(), document_.options(),
                   fmt::format("image {}", index));
  const tinygltf::BufferView& view = document_.model().bufferViews[source["bufferView"].get<std::size_t>()];
  const auto bytes =
      std::as_bytes(std::span(document_.model().buffers[static_cast<std::size_t>(view.buffer)].data))
          .subspan(view.byteOffset, view.byteLength);
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

}  // namespace lambent::baker
