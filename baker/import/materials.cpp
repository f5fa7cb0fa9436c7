#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/convert.hpp"
#include "baker/import/tinygltf.hpp"
#include "baker/import/uri.hpp"

namespace lambent::baker {
namespace {

float numberOr(const tinygltf::Value& object, const char* key, float fallback) {
  return object.Has(key) && object.Get(key).IsNumber()
             ? static_cast<float>(object.Get(key).GetNumberAsDouble())
             : fallback;
}

glm::vec2 pairOr(const tinygltf::Value& object, const char* key, glm::vec2 fallback) {
  if (!object.Has(key)) return fallback;
  const tinygltf::Value& pair = object.Get(key);
  if (!pair.IsArray() || pair.ArrayLen() != 2 || !pair.Get(0).IsNumber() || !pair.Get(1).IsNumber())
    return fallback;
  return {static_cast<float>(pair.Get(0).GetNumberAsDouble()),
          static_cast<float>(pair.Get(1).GetNumberAsDouble())};
}

// A textureInfo without its texture: the set of coordinates and KHR_texture_transform.
gltf::TextureRef placement(const tinygltf::ExtensionMap& extensions, int texcoord) {
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

// The type by the first bytes; what the file says about it is often wrong.
std::string imageType(const std::vector<std::byte>& bytes) {
  constexpr std::array<unsigned char, 4> kPng{0x89, 'P', 'N', 'G'};
  constexpr std::array<unsigned char, 3> kJpeg{0xff, 0xd8, 0xff};
  if (bytes.size() > 8 && std::memcmp(bytes.data(), kPng.data(), kPng.size()) == 0) return "image/png";
  if (bytes.size() > 8 && std::memcmp(bytes.data(), kJpeg.data(), kJpeg.size()) == 0) return "image/jpeg";
  return {};
}

// Textures and images are taken over when the first material asks for them.
class Textures {
 public:
  Textures(const Document& document, Scene& scene)
      : document_(document),
        scene_(scene),
        texture_of_(document.model().textures.size(), kUnknown),
        image_of_(document.json().contains("images") ? document.json()["images"].size() : 0, kUnknown) {}

  // The reference of a material, `use` in words; without a texture where it has none that can be used.
  Result<gltf::TextureRef> refer(int index, const tinygltf::ExtensionMap& extensions, int texcoord,
                                 std::size_t material, const char* use) {
    if (index < 0) return gltf::TextureRef{};
    gltf::TextureRef ref = placement(extensions, texcoord);
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

 private:
  static constexpr std::int32_t kUnknown = -2;

  // The scene's texture for the file's, -1 where it has no image that can be used.
  Result<std::int32_t> take(int index) {
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

  Result<std::int32_t> takeImage(int index) {
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

  Result<std::vector<std::byte>> imageBytes(const nlohmann::json& source, int index) const {
    if (source.contains("uri"))
      return readUri(document_.path(), source["uri"].get<std::string>(), document_.options(),
                     fmt::format("image {}", index));
    const tinygltf::BufferView& view = document_.model().bufferViews[source["bufferView"].get<std::size_t>()];
    const auto bytes =
        std::as_bytes(std::span(document_.model().buffers[static_cast<std::size_t>(view.buffer)].data))
            .subspan(view.byteOffset, view.byteLength);
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  }

  const Document& document_;
  Scene& scene_;
  std::vector<std::int32_t> texture_of_, image_of_;
};

// Colours and factors come as lists of doubles of any length; what is missing or not finite keeps its
// default.
template <typename Vector>
void assign(Vector& target, const std::vector<double>& values) {
  if (values.size() != static_cast<std::size_t>(Vector::length())) return;
  for (int i = 0; i < Vector::length(); ++i)
    if (std::isfinite(values[static_cast<std::size_t>(i)]))
      target[i] = std::max(static_cast<float>(values[static_cast<std::size_t>(i)]), 0.0f);
}

gltf::Material convertMaterial(const tinygltf::Material& source) {
  gltf::Material material;
  material.name = source.name;
  assign(material.base_color, source.pbrMetallicRoughness.baseColorFactor);
  assign(material.emissive, source.emissiveFactor);
  if (const auto strength = source.extensions.find("KHR_materials_emissive_strength");
      strength != source.extensions.end())
    material.emissive *= numberOr(strength->second, "emissiveStrength", 1.0f);
  for (int c = 0; c < 3; ++c)  // the product of two large numbers need not be one
    material.emissive[c] = std::min(material.emissive[c], std::numeric_limits<float>::max());
  material.unlit = source.extensions.contains("KHR_materials_unlit");
  material.base_color = glm::min(material.base_color, glm::vec4(1.0f));
  material.metallic = static_cast<float>(source.pbrMetallicRoughness.metallicFactor);
  material.roughness = static_cast<float>(source.pbrMetallicRoughness.roughnessFactor);
  material.double_sided = source.doubleSided;
  if (source.alphaMode == "MASK") material.alpha_mode = gltf::AlphaMode::Mask;
  if (source.alphaMode == "BLEND") material.alpha_mode = gltf::AlphaMode::Blend;
  material.alpha_cutoff = static_cast<float>(source.alphaCutoff);
  return material;
}

// What the textures of a material are, and what becomes of it without those that cannot be used.
Result<void> addTextures(const tinygltf::Material& source, std::size_t number, Textures& textures,
                         std::vector<std::string>& warnings, gltf::Material& material) {
  const auto assign = [](gltf::TextureRef& target, Result<gltf::TextureRef> ref) -> Result<void> {
    if (!ref) return failAgain(std::move(ref.error()));
    target = *ref;
    return {};
  };
  const auto& base = source.pbrMetallicRoughness.baseColorTexture;
  Result<void> done =
      assign(material.base_color_texture,
             textures.refer(base.index, base.extensions, base.texCoord, number, "base colour texture"));
  if (!done) return done;
  const auto& normal = source.normalTexture;
  done = assign(material.normal_texture,
                textures.refer(normal.index, normal.extensions, normal.texCoord, number, "normal texture"));
  if (!done) return done;
  if (material.normal_texture.texture >= 0 && std::isfinite(normal.scale))
    material.normal_scale = static_cast<float>(normal.scale);
  const auto& emissive = source.emissiveTexture;
  if (material.emissive == glm::vec3(0.0f) || emissive.index < 0) return {};
  done = assign(material.emissive_texture, textures.refer(emissive.index, emissive.extensions,
                                                          emissive.texCoord, number, "emissive texture"));
  if (done && material.emissive_texture.texture < 0) {
    // All of the surface would shine where the texture says where it does.
    warnings.push_back(fmt::format("material {}: without its emissive texture it does not shine", number));
    material.emissive = glm::vec3(0.0f);
  }
  return done;
}

}  // namespace

Result<void> convertMaterials(const Document& document, Scene& scene) {
  Textures textures(document, scene);
  for (const tinygltf::Material& source : document.model().materials) {
    gltf::Material material = convertMaterial(source);
    if (auto done = addTextures(source, scene.materials.size(), textures, scene.warnings, material); !done)
      return done;
    scene.materials.push_back(std::move(material));
  }
  return {};
}

}  // namespace lambent::baker
