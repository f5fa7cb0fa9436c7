// Converts materials: numbers and colours by the table of a material's fields, textures and images when the
// first material uses them, and measured BRDFs when one names them. Mends have seen to all values.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string_view>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "baker/import/check.hpp"
#include "baker/import/convert.hpp"
#include "baker/import/image.hpp"
#include "baker/import/measured_brdf.hpp"
#include "baker/import/scene_files.hpp"
#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;

const json& extensionOf(const json& source, const char* name) {
  return memberOf(source, {"extensions", name});
}

// Returns a textureInfo without its texture: the coordinate set and KHR_texture_transform.
gltf::TextureRef placementOf(const json& info) {
  gltf::TextureRef ref;
  readMember(info, "texCoord", ref.texcoord);
  const json& transform = extensionOf(info, "KHR_texture_transform");
  readMember(transform, "offset", ref.offset);
  readMember(transform, "scale", ref.scale);
  readMember(transform, "rotation", ref.rotation_rad);
  readMember(transform, "texCoord", ref.texcoord);
  return ref;
}

// Returns the images that a texture names, its own one first, then those for readers of an extension.
std::vector<std::size_t> imagesOf(const json& texture, std::size_t count) {
  std::vector<std::size_t> images;
  const auto add = [&](const json& owner) {
    if (!owner.is_object() || !owner.contains("source")) return;
    const json& source = owner["source"];
    if (source.is_number_unsigned() && source.get<std::size_t>() < count)
      images.push_back(source.get<std::size_t>());
  };
  add(texture);
  if (texture.contains("extensions"))
    for (const json& extension : texture["extensions"]) add(extension);
  return images;
}

// Reads the numbers and colours of reflection and of panes, by the table of a material's fields. Of those in
// extensions, unlit and measured materials keep only the index of refraction.
void readFactors(const json& source, gltf::Material& material) {
  const bool has_lobes = !material.unlit && material.brdf < 0;
  gltf::forEachMaterialField([&]<class Row>(const Row& row) {
    using Value = typename Row::Value;
    if constexpr (std::is_same_v<Value, float> || std::is_same_v<Value, glm::vec3>) {
      const auto [outer, inner] = row.json.objects;
      const bool in_extension = inner != nullptr;
      const bool wanted = has_lobes || !in_extension || std::string_view(row.json.key) == "ior";
      const bool of_pane = in_extension && row.part == gltf::MaterialPart::Opacity;
      if (!wanted || !(of_pane || row.part == gltf::MaterialPart::Reflection)) return;
      const json& place = outer ? memberOf(source, {outer}) : source;
      readMember(inner ? memberOf(place, {inner}) : place, row.json.key, material.*row.member);
    }
  });
}

gltf::Material convertMaterial(const json& source) {
  gltf::Material material;
  material.name = source.value("name", "");
  readMember(memberOf(source, {"pbrMetallicRoughness"}), "baseColorFactor", material.base_color);
  readMember(source, "emissiveFactor", material.emissive);
  float strength = 1.0f;
  readMember(extensionOf(source, "KHR_materials_emissive_strength"), "emissiveStrength", strength);
  material.emissive *= strength;
  material.unlit = !extensionOf(source, "KHR_materials_unlit").is_null();
  material.double_sided = source.value("doubleSided", false);
  const std::string mode = source.value("alphaMode", "OPAQUE");
  if (mode == "MASK") material.alpha_mode = gltf::AlphaMode::Mask;
  if (mode == "BLEND") material.alpha_mode = gltf::AlphaMode::Blend;
  readMember(source, "alphaCutoff", material.alpha_cutoff);
  return material;
}

// Returns the index of the value in the list, whose last one it becomes.
template <typename T>
std::int32_t appended(std::vector<T>& list, T value) {
  list.push_back(std::move(value));
  return static_cast<std::int32_t>(list.size()) - 1;
}

class MaterialConverter {
 public:
  MaterialConverter(const Document& document, Scene& scene)
      : document_(document),
        scene_(scene),
        texture_of_(document.list("textures").size(), kUnknown),
        image_of_(document.list("images").size(), kUnknown) {}

  void convert(const json& source) {
    number_ = scene_.materials.size();
    gltf::Material material = convertMaterial(source);
    addTextures(source, material);
    bindMeasured(source, material);
    convertReflection(source, material);
    scene_.materials.push_back(std::move(material));
  }

 private:
  static constexpr std::int32_t kUnknown = -2;

  // Returns the texture reference `key` of a material, without a texture if none is usable, which is a
  // warning. `use` names it there.
  gltf::TextureRef refer(const json& place, const char* key, const char* use) {
    const json& info = memberOf(place, {key});
    if (info.is_null()) return {};
    gltf::TextureRef ref = placementOf(info);
    if (ref.texcoord > 1) {
      scene_.warnings.push_back(
          fmt::format("material {}: its {} uses TEXCOORD_{}: only 0 and 1 are read, it is left out", number_,
                      use, ref.texcoord));
      return {};
    }
    ref.texture = take(info.at("index").get<std::size_t>());
    return ref.texture < 0 ? gltf::TextureRef{} : ref;
  }

  // Returns the reference with the texture of roughness in place of that of glossiness, which is in its
  // alpha.
  gltf::TextureRef roughnessOf(gltf::TextureRef ref, float factor) {
    if (ref.texture < 0) return ref;
    const auto [known, added] = roughness_of_.try_emplace({ref.texture, factor}, -1);
    if (added) {
      gltf::Texture texture = scene_.textures[static_cast<std::size_t>(ref.texture)];
      try {
        auto roughness = roughnessImage(scene_.images[static_cast<std::size_t>(texture.image)], factor);
        texture.image = appended(scene_.images, std::move(roughness));
        known->second = appended(scene_.textures, texture);
      } catch (const Error& error) {
        scene_.warnings.push_back(error.line());
      }
    }
    ref.texture = known->second;
    return ref;
  }

  // Returns the scene's texture for the file's, or -1 if it has no usable image.
  std::int32_t take(std::size_t index) {
    std::int32_t& texture = texture_of_[index];
    if (texture != kUnknown) return texture;
    texture = -1;
    const json& source = document_.at("textures", index);
    const auto images = imagesOf(source, image_of_.size());
    if (images.empty())
      scene_.warnings.push_back(fmt::format("texture {} names no image and is left out", index));
    gltf::Texture out;
    for (const std::size_t image : images)
      if (out.image < 0) out.image = takeImage(image);
    if (out.image < 0) return texture;
    if (source.contains("sampler")) {
      const json& sampler = document_.at("samplers", source["sampler"].get<std::size_t>());
      readMember(sampler, "wrapS", out.sampler.wrap_s);
      readMember(sampler, "wrapT", out.sampler.wrap_t);
      readMember(sampler, "magFilter", out.sampler.mag_filter);
      readMember(sampler, "minFilter", out.sampler.min_filter);
    }
    return texture = appended(scene_.textures, out);
  }

  std::int32_t takeImage(std::size_t index) {
    std::int32_t& image = image_of_[index];
    if (image != kUnknown) return image;
    image = -1;
    const json& source = document_.at("images", index);
    const std::string uri = source.value("uri", "");
    const std::string file = uri.starts_with("data:") ? "" : uri;
    try {
      std::string name = source.value("name", "");
      if (name.empty()) name = decodePercent(file);
      image = appended(scene_.images, storableImage(std::move(name), imageBytes(source, index)));
    } catch (const Error& error) {
      scene_.warnings.push_back(fmt::format("image {}{}: {}, so surfaces look as without it ({})", index,
                                            file.empty() ? "" : fmt::format(" (\"{}\")", file.substr(0, 80)),
                                            error.problem, error.hint));
    }
    return image;
  }

  std::vector<std::byte> imageBytes(const json& source, std::size_t index) {
    if (source.contains("uri"))
      return readUri(document_.path, source["uri"].get<std::string>(), document_.options,
                     fmt::format("image {}", index), scene_.warnings);
    if (!source.contains("bufferView"))
      throw Error{{}, "names neither a file nor a bufferView", "name a file"};
    const auto bytes = document_.view(source["bufferView"].get<std::size_t>());
    return {bytes.begin(), bytes.end()};
  }

  // Adds the textures of a material, and adapts it if they cannot be used.
  void addTextures(const json& source, gltf::Material& material) {
    material.base_color_texture =
        refer(memberOf(source, {"pbrMetallicRoughness"}), "baseColorTexture", "base color texture");
    material.normal_texture = refer(source, "normalTexture", "normal texture");
    if (material.normal_texture.texture >= 0)
      readMember(source["normalTexture"], "scale", material.normal_scale);
    if (material.emissive == glm::vec3(0.0f) || !source.contains("emissiveTexture")) return;
    material.emissive_texture = refer(source, "emissiveTexture", "emissive texture");
    if (material.emissive_texture.texture < 0) {
      // Without the texture, all of the surface would shine instead of the part that the texture selects.
      scene_.warnings.push_back(
          fmt::format("material {}: without its emissive texture it does not shine", number_));
      material.emissive = glm::vec3(0.0f);
    }
  }

  // Sets Material::brdf if the material's `extras.lambent.brdf` names a file. Errors: those of resolveUri and
  // readMeasuredBrdf, with the material's number.
  void bindMeasured(const json& source, gltf::Material& material) {
    const json& name = memberOf(source, {"extras", "lambent", "brdf"});
    if (name.is_null()) return;
    if (!name.is_string()) refuse("material {}: extras: lambent: brdf is not a string", number_);
    const std::string object = fmt::format("the BRDF of material {}", number_);
    const auto file =
        resolveUri(document_.path, name.get<std::string>(), document_.options, object, scene_.warnings);
    const auto [known, added] = brdf_of_.try_emplace(file, static_cast<std::int32_t>(scene_.brdfs.size()));
    material.brdf = known->second;
    if (!added) return;
    auto measured = readMeasuredBrdf(file);
    if (!measured)
      measured.error().subject =
          fmt::format("{}: {} ({})", document_.file(), object, file.filename().string());
    scene_.brdfs.push_back(orThrow(std::move(measured)));
  }

  // Converts KHR_materials_pbrSpecularGlossiness, which replaces the rest. Both models have the same lobes:
  // the dielectric's reflectance at normal incidence times its colour is the extension's specular colour. One
  // whose diffuse colour is black is a metal.
  void convertSpecularGlossiness(const json& extension, gltf::Material& material) {
    glm::vec3 specular(1.0f);
    float glossiness = 1.0f;
    material.base_color = glm::vec4(1.0f);
    readMember(extension, "diffuseFactor", material.base_color);
    readMember(extension, "specularFactor", specular);
    readMember(extension, "glossinessFactor", glossiness);
    const gltf::TextureRef both =
        refer(extension, "specularGlossinessTexture", "specular-glossiness texture");
    material.roughness = both.texture < 0 ? 1.0f - glossiness : 1.0f;
    material.metallic_roughness_texture = roughnessOf(both, glossiness);
    material.specular = 1.0f;
    // The alpha of its texture is glossiness, which would cut holes into a metal that is not opaque.
    if (glm::vec3(material.base_color) == glm::vec3(0.0f) && material.alpha_mode == gltf::AlphaMode::Opaque) {
      material.metallic = 1.0f;
      material.base_color = glm::vec4(specular, material.base_color.a);
      material.base_color_texture = both;
      return;
    }
    material.metallic = 0.0f;
    material.base_color_texture = refer(extension, "diffuseTexture", "diffuse texture");
    const float most = std::max({specular.r, specular.g, specular.b});
    const float amplitude = std::sqrt(most);  // (ior - 1) / (ior + 1); 0 stands for an infinite index
    material.ior = amplitude < 1.0f ? (1.0f + amplitude) / (1.0f - amplitude) : 0.0f;
    material.specular_color = most > 0.0f ? specular / most : glm::vec3(1.0f);
    material.specular_color_texture = both;
  }

  // Reads what a material reflects. Unlit, base colour and brdf must be set before; textures that could
  // change nothing are left out of the scene.
  void convertReflection(const json& source, gltf::Material& material) {
    readFactors(source, material);
    if (const json& glossiness = extensionOf(source, "KHR_materials_pbrSpecularGlossiness");
        !glossiness.is_null())
      return convertSpecularGlossiness(glossiness, material);
    if (material.unlit || material.brdf >= 0) return;
    if (material.transmits())
      material.transmission_texture = refer(extensionOf(source, "KHR_materials_transmission"),
                                            "transmissionTexture", "transmission texture");
    const json& specular = extensionOf(source, "KHR_materials_specular");
    if (material.specular > 0.0f)
      material.specular_texture = refer(specular, "specularTexture", "specular texture");
    if (material.specular > 0.0f && material.specular_color != glm::vec3(0.0f))
      material.specular_color_texture = refer(specular, "specularColorTexture", "specular color texture");
    if (material.anisotropy > 0.0f)
      material.anisotropy_texture =
          refer(extensionOf(source, "KHR_materials_anisotropy"), "anisotropyTexture", "anisotropy texture");
    if (material.metallic > 0.0f || (material.specular > 0.0f && material.roughness > 0.0f))
      material.metallic_roughness_texture = refer(memberOf(source, {"pbrMetallicRoughness"}),
                                                  "metallicRoughnessTexture", "metallic-roughness texture");
  }

  const Document& document_;
  Scene& scene_;
  std::size_t number_ = 0;  // of the material at hand
  std::vector<std::int32_t> texture_of_, image_of_;
  std::map<std::pair<std::int32_t, float>, std::int32_t> roughness_of_;  // by texture and factor
  std::map<std::filesystem::path, std::int32_t> brdf_of_;  // materials that name one file share its BRDF
};

}  // namespace

void convertMaterials(const Document& document, Scene& scene) {
  MaterialConverter converter(document, scene);
  for (const json& source : document.list("materials")) converter.convert(source);
}

}  // namespace lambent::baker
