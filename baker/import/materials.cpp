#include <fmt/format.h>

#include "baker/import/convert.hpp"
#include "baker/import/material_textures.hpp"
#include "baker/import/reflection.hpp"

namespace lambent::baker {
namespace {

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
