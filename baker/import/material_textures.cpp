#include "baker/import/material_textures.hpp"

#include <algorithm>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/storable_image.hpp"
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
