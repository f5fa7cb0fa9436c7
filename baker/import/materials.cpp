#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

#include <fmt/format.h>

#include "baker/import/container.hpp"
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

// KHR_texture_transform: uv' = offset + R(rotation) * (scale * uv), with R as the extension writes it.
UvTransform uvTransform(const tinygltf::TextureInfo& info) {
  UvTransform transform{.texcoord = static_cast<std::uint32_t>(info.texCoord)};
  const auto extension = info.extensions.find("KHR_texture_transform");
  if (extension == info.extensions.end() || !extension->second.IsObject()) return transform;
  const tinygltf::Value& value = extension->second;
  const glm::vec2 offset = pairOr(value, "offset", glm::vec2(0.0f)),
                  scale = pairOr(value, "scale", glm::vec2(1.0f));
  const float angle = numberOr(value, "rotation", 0.0f);
  const float c = std::cos(angle), s = std::sin(angle);
  transform.matrix =
      glm::mat3(scale.x * c, -scale.x * s, 0.0f, scale.y * s, scale.y * c, 0.0f, offset.x, offset.y, 1.0f);
  const float texcoord = numberOr(value, "texCoord", static_cast<float>(info.texCoord));
  transform.texcoord = static_cast<std::uint32_t>(std::clamp(texcoord, 0.0f, 255.0f));
  transform.identity = transform.matrix == glm::mat3(1.0f);
  return transform;
}

// The type by the first bytes; what the file says about it is often wrong.
std::string imageType(const std::vector<std::byte>& bytes) {
  constexpr std::array<unsigned char, 4> kPng{0x89, 'P', 'N', 'G'};
  constexpr std::array<unsigned char, 3> kJpeg{0xff, 0xd8, 0xff};
  if (bytes.size() > 8 && std::memcmp(bytes.data(), kPng.data(), kPng.size()) == 0) return "image/png";
  if (bytes.size() > 8 && std::memcmp(bytes.data(), kJpeg.data(), kJpeg.size()) == 0) return "image/jpeg";
  return {};
}

// Textures and images are taken over when the first base colour asks for them.
class Textures {
 public:
  Textures(const Document& document, Scene& scene)
      : document_(document),
        scene_(scene),
        texture_of_(document.model().textures.size(), kUnknown),
        image_of_(document.model().images.size(), kUnknown) {}

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

 private:
  static constexpr std::int32_t kUnknown = -2;

  Result<std::int32_t> takeImage(int index) {
    std::int32_t& image = image_of_[static_cast<std::size_t>(index)];
    if (image != kUnknown) return image;
    const tinygltf::Image& source = document_.model().images[static_cast<std::size_t>(index)];
    auto bytes = imageBytes(source, index);
    if (!bytes) return failAgain(std::move(bytes.error()));
    image = -1;
    const std::string type = imageType(*bytes);
    if (type.empty()) {
      scene_.warnings.push_back(fmt::format("image {} is neither PNG nor JPEG and is left out", index));
      return image;
    }
    image = static_cast<std::int32_t>(scene_.images.size());
    scene_.images.push_back(
        {source.name.empty() ? decodePercent(source.uri) : source.name, type, std::move(*bytes)});
    return image;
  }

  Result<std::vector<std::byte>> imageBytes(const tinygltf::Image& source, int index) const {
    if (source.uri.empty()) {  // embedded, kept encoded by the loader
      const auto bytes = std::as_bytes(std::span(source.image));
      return std::vector<std::byte>(bytes.begin(), bytes.end());
    }
    const std::string object = fmt::format("image {}", index);
    auto file = resolveUri(document_.path().parent_path(), source.uri, document_.file(), object);
    if (!file) return failAgain(std::move(file.error()));
    return readBytes(*file, fmt::format("{}: {} ({})", document_.file(), object, file->filename().string()));
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
  material.base_color = glm::min(material.base_color, glm::vec4(1.0f));
  material.metallic = static_cast<float>(source.pbrMetallicRoughness.metallicFactor);
  material.roughness = static_cast<float>(source.pbrMetallicRoughness.roughnessFactor);
  material.double_sided = source.doubleSided;
  if (source.alphaMode == "MASK") material.alpha_mode = gltf::AlphaMode::Mask;
  if (source.alphaMode == "BLEND") material.alpha_mode = gltf::AlphaMode::Blend;
  material.alpha_cutoff = static_cast<float>(source.alphaCutoff);
  return material;
}

}  // namespace

Result<std::vector<UvTransform>> convertMaterials(const Document& document, Scene& scene) {
  Textures textures(document, scene);
  std::vector<UvTransform> transforms;
  for (const tinygltf::Material& source : document.model().materials) {
    gltf::Material material = convertMaterial(source);
    const tinygltf::TextureInfo& info = source.pbrMetallicRoughness.baseColorTexture;
    UvTransform transform = uvTransform(info);
    if (info.index >= 0 && transform.texcoord > 1) {
      scene.warnings.push_back(
          fmt::format("material {} uses TEXCOORD_{}: only 0 and 1 are read, its texture is left out",
                      scene.materials.size(), transform.texcoord));
    } else if (info.index >= 0) {
      auto texture = textures.take(info.index);
      if (!texture) return failAgain(std::move(texture.error()));
      material.base_color_texture = {*texture, transform.texcoord};
    }
    transforms.push_back(transform);
    scene.materials.push_back(std::move(material));
  }
  return transforms;
}

}  // namespace lambent::baker
