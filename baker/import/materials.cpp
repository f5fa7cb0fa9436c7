#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/convert.hpp"
#include "baker/import/material_textures.hpp"
#include "baker/import/measured_brdf.hpp"
#include "baker/import/scene_files.hpp"
#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker {

namespace {

// Converts what the surfaces of a material reflect besides their base colour: numbers and colours by the
// table of a material's fields, their textures, and measured BRDFs, which are read when the first material
// names them. Only this room includes this header.

// Reads the measured BRDFs of a scene; materials that name one file share one entry of Scene::brdfs.
class MeasuredBrdfs {
 public:
  MeasuredBrdfs(const Document& document, Scene& scene) : document_(document), scene_(scene) {}

  // Sets Material::brdf if the material's `extras.lambent.brdf` names a file. Errors: those of resolveUri and
  // readMeasuredBrdf, with the material's number.
  Result<void> bind(const tinygltf::Material& source, std::size_t number, gltf::Material& material);

 private:
  const Document& document_;
  Scene& scene_;
  std::map<std::filesystem::path, std::int32_t> number_of_;
};

constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";

const tinygltf::Value* extensionOf(const tinygltf::Material& source, const char* name) {
  const auto found = source.extensions.find(name);
  return found != source.extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

void readField(const nlohmann::json& value, float& factor) {
  factor = value.get<float>();
}
void readField(const nlohmann::json& value, glm::vec3& color) {
  for (int c = 0; c < 3; ++c) color[c] = value[static_cast<std::size_t>(c)].get<float>();
}

// Reads the numbers and colours of reflection and of panes, by the table of a material's fields. Of those in
// extensions, unlit and measured materials keep only the index of refraction.
void readFactors(const nlohmann::json& source, gltf::Material& material) {
  const bool has_lobes = !material.unlit && material.brdf < 0;
  gltf::forEachMaterialField([&]<class Row>(const Row& row) {
    using Value = typename Row::Value;
    if constexpr (std::is_same_v<Value, float> || std::is_same_v<Value, glm::vec3>) {
      const auto& objects = row.json.objects;
      const bool in_extension = objects[1] != nullptr;
      const bool wanted = has_lobes || !in_extension || std::string_view(row.json.key) == "ior";
      const bool of_pane = in_extension && row.part == gltf::MaterialPart::Opacity;
      if (!wanted || !(of_pane || row.part == gltf::MaterialPart::Reflection)) return;
      const nlohmann::json* place = &source;
      for (const char* object : objects) {
        if (!object) continue;
        const auto found = place->find(object);
        if (found == place->end()) return;
        place = &*found;
      }
      if (const auto value = place->find(row.json.key); value != place->end())
        readField(*value, material.*row.member);
    }
  });
}

// Adds the textures of KHR_materials_specular that could change anything.
void referSpecular(const tinygltf::Value& extension, std::size_t number, MaterialTextures& textures,
                   gltf::Material& material) {
  if (material.specular <= 0.0f) return;
  material.specular_texture = textures.refer(extension, "specularTexture", number, "specular texture");
  if (material.specular_color != glm::vec3(0.0f))
    material.specular_color_texture =
        textures.refer(extension, "specularColorTexture", number, "specular color texture");
}

// Converts KHR_materials_pbrSpecularGlossiness, which replaces the rest. Both models have the same lobes: the
// dielectric's reflectance at normal incidence times its colour is the extension's specular colour. One whose
// diffuse colour is black is a metal.
void convertSpecularGlossiness(const nlohmann::json& source, const tinygltf::Value& extension,
                               std::size_t number, MaterialTextures& textures, gltf::Material& material) {
  glm::vec3 specular(1.0f);
  float glossiness = 1.0f;
  material.base_color = glm::vec4(1.0f);
  if (const auto color = source.find("diffuseFactor"); color != source.end())
    for (int c = 0; c < 4; ++c) material.base_color[c] = (*color)[static_cast<std::size_t>(c)].get<float>();
  if (const auto color = source.find("specularFactor"); color != source.end()) readField(*color, specular);
  if (const auto value = source.find("glossinessFactor"); value != source.end())
    readField(*value, glossiness);
  const gltf::TextureRef both =
      textures.refer(extension, "specularGlossinessTexture", number, "specular-glossiness texture");
  material.roughness = both.texture < 0 ? 1.0f - glossiness : 1.0f;
  material.metallic_roughness_texture = textures.roughnessOf(both, glossiness);
  material.specular = 1.0f;
  // The alpha of its texture is glossiness, which would cut holes into a metal that is not opaque.
  if (glm::vec3(material.base_color) == glm::vec3(0.0f) && material.alpha_mode == gltf::AlphaMode::Opaque) {
    material.metallic = 1.0f;
    material.base_color = glm::vec4(specular, material.base_color.a);
    material.base_color_texture = both;
    return;
  }
  material.metallic = 0.0f;
  material.base_color_texture = textures.refer(extension, "diffuseTexture", number, "diffuse texture");
  const float most = std::max({specular.r, specular.g, specular.b});
  const float amplitude = std::sqrt(most);  // (ior - 1) / (ior + 1); 0 stands for an infinite index
  material.ior = amplitude < 1.0f ? (1.0f + amplitude) / (1.0f - amplitude) : 0.0f;
  material.specular_color = most > 0.0f ? specular / most : glm::vec3(1.0f);
  material.specular_color_texture = both;
}

Result<void> MeasuredBrdfs::bind(const tinygltf::Material& source, std::size_t number,
                                 gltf::Material& material) {
  if (!source.extras.IsObject() || !source.extras.Has("lambent")) return {};
  const tinygltf::Value& lambent = source.extras.Get("lambent");
  if (!lambent.IsObject() || !lambent.Has("brdf") || !lambent.Get("brdf").IsString()) return {};
  const std::string object = fmt::format("the BRDF of material {}", number);
  auto file = resolveUri(document_.path(), lambent.Get("brdf").Get<std::string>(), document_.options(),
                         object, scene_.warnings);
  if (!file) return failAgain(std::move(file.error()));
  const auto [known, added] = number_of_.try_emplace(*file, static_cast<std::int32_t>(scene_.brdfs.size()));
  material.brdf = known->second;
  if (!added) return {};
  auto measured = readMeasuredBrdf(*file);
  if (!measured) {
    measured.error().subject =
        fmt::format("{}: {} ({})", document_.file(), object, file->filename().string());
    return failAgain(std::move(measured.error()));
  }
  scene_.brdfs.push_back(std::move(*measured));
  return {};
}

// Reads what material `number` of the file reflects. Unlit, base colour and brdf must be set before; textures
// that could change nothing are left out of the scene.
void convertReflection(const Document& document, std::size_t number, MaterialTextures& textures,
                       gltf::Material& material) {
  const nlohmann::json& fields = document.json()["materials"][number];
  const tinygltf::Material& source = document.model().materials[number];
  readFactors(fields, material);
  if (const auto* glossiness = extensionOf(source, kSpecularGlossiness)) {
    convertSpecularGlossiness(fields["extensions"][kSpecularGlossiness], *glossiness, number, textures,
                              material);
    return;
  }
  if (material.unlit || material.brdf >= 0) return;
  const auto* transmission = extensionOf(source, "KHR_materials_transmission");
  if (transmission && material.transmits())
    material.transmission_texture =
        textures.refer(*transmission, "transmissionTexture", number, "transmission texture");
  if (const auto* specular = extensionOf(source, "KHR_materials_specular"))
    referSpecular(*specular, number, textures, material);
  const auto* anisotropy = extensionOf(source, "KHR_materials_anisotropy");
  if (anisotropy && material.anisotropy > 0.0f)
    material.anisotropy_texture =
        textures.refer(*anisotropy, "anisotropyTexture", number, "anisotropy texture");
  const auto& texture = source.pbrMetallicRoughness.metallicRoughnessTexture;
  if (material.metallic > 0.0f || (material.specular > 0.0f && material.roughness > 0.0f))
    material.metallic_roughness_texture = textures.refer(texture.index, texture.extensions, texture.texCoord,
                                                         number, "metallic-roughness texture");
}

// Copies a colour, which tinygltf has as a list of doubles; a missing one is empty.
template <typename Vector>
void assignVector(Vector& target, const std::vector<double>& values) {
  for (int i = 0; i < static_cast<int>(values.size()); ++i)
    target[i] = static_cast<float>(values[static_cast<std::size_t>(i)]);
}

gltf::Material convertMaterial(const tinygltf::Material& source) {
  gltf::Material material;
  material.name = source.name;
  assignVector(material.base_color, source.pbrMetallicRoughness.baseColorFactor);
  assignVector(material.emissive, source.emissiveFactor);
  if (const auto strength = source.extensions.find("KHR_materials_emissive_strength");
      strength != source.extensions.end())
    material.emissive *= numberOr(strength->second, "emissiveStrength", 1.0f);
  material.unlit = source.extensions.contains("KHR_materials_unlit");
  material.double_sided = source.doubleSided;
  if (source.alphaMode == "MASK") material.alpha_mode = gltf::AlphaMode::Mask;
  if (source.alphaMode == "BLEND") material.alpha_mode = gltf::AlphaMode::Blend;
  material.alpha_cutoff = static_cast<float>(source.alphaCutoff);
  return material;
}

// Adds the textures of a material, and adapts it if they cannot be used.
void addTextures(const tinygltf::Material& source, std::size_t number, MaterialTextures& textures,
                 std::vector<std::string>& warnings, gltf::Material& material) {
  const auto& base = source.pbrMetallicRoughness.baseColorTexture;
  material.base_color_texture =
      textures.refer(base.index, base.extensions, base.texCoord, number, "base color texture");
  const auto& normal = source.normalTexture;
  material.normal_texture =
      textures.refer(normal.index, normal.extensions, normal.texCoord, number, "normal texture");
  if (material.normal_texture.texture >= 0) material.normal_scale = static_cast<float>(normal.scale);
  const auto& emissive = source.emissiveTexture;
  if (material.emissive == glm::vec3(0.0f) || emissive.index < 0) return;
  material.emissive_texture =
      textures.refer(emissive.index, emissive.extensions, emissive.texCoord, number, "emissive texture");
  if (material.emissive_texture.texture < 0) {
    // Without the texture, all of the surface would shine instead of the part that the texture selects.
    warnings.push_back(fmt::format("material {}: without its emissive texture it does not shine", number));
    material.emissive = glm::vec3(0.0f);
  }
}

}  // namespace

Result<void> convertMaterials(const Document& document, Scene& scene) {
  MaterialTextures textures(document, scene);
  MeasuredBrdfs measured(document, scene);
  for (const tinygltf::Material& source : document.model().materials) {
    gltf::Material material = convertMaterial(source);
    addTextures(source, scene.materials.size(), textures, scene.warnings, material);
    if (auto done = measured.bind(source, scene.materials.size(), material); !done) return done;
    convertReflection(document, scene.materials.size(), textures, material);
    scene.materials.push_back(std::move(material));
  }
  if (document.options().whole_images && textures.lacksImages())
    return fail(document.file(), "has an image that cannot be read", "write it again");
  return {};
}

}  // namespace lambent::baker
