#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "baker/import/convert.hpp"
#include "baker/import/material_textures.hpp"
#include "baker/import/reflection.hpp"

namespace lambent::baker {
namespace {

// Copies colours and factors, which are lists of doubles of any length; values that are missing or not finite
// keep their default.
template <typename Vector>
void assignVector(Vector& target, const std::vector<double>& values) {
  if (values.size() != static_cast<std::size_t>(Vector::length())) return;
  for (int i = 0; i < Vector::length(); ++i)
    if (std::isfinite(values[static_cast<std::size_t>(i)]))
      target[i] = std::max(static_cast<float>(values[static_cast<std::size_t>(i)]), 0.0f);
}

gltf::Material convertMaterial(const tinygltf::Material& source) {
  gltf::Material material;
  material.name = source.name;
  assignVector(material.base_color, source.pbrMetallicRoughness.baseColorFactor);
  assignVector(material.emissive, source.emissiveFactor);
  if (const auto strength = source.extensions.find("KHR_materials_emissive_strength");
      strength != source.extensions.end())
    material.emissive *= numberOr(strength->second, "emissiveStrength", 1.0f);
  for (int c = 0; c < 3; ++c)  // the product of two large numbers may overflow
    material.emissive[c] = std::min(material.emissive[c], std::numeric_limits<float>::max());
  material.unlit = source.extensions.contains("KHR_materials_unlit");
  material.base_color = glm::min(material.base_color, glm::vec4(1.0f));
  material.double_sided = source.doubleSided;
  if (source.alphaMode == "MASK") material.alpha_mode = gltf::AlphaMode::Mask;
  if (source.alphaMode == "BLEND") material.alpha_mode = gltf::AlphaMode::Blend;
  material.alpha_cutoff = static_cast<float>(source.alphaCutoff);
  return material;
}

// Adds the textures of a material, and adapts it if they cannot be used.
Result<void> addTextures(const tinygltf::Material& source, std::size_t number, MaterialTextures& textures,
                         std::vector<std::string>& warnings, gltf::Material& material) {
  const auto assign = [](gltf::TextureRef& target, Result<gltf::TextureRef> ref) -> Result<void> {
    if (!ref) return failAgain(std::move(ref.error()));
    target = *ref;
    return {};
  };
  const auto& base = source.pbrMetallicRoughness.baseColorTexture;
  Result<void> done =
      assign(material.base_color_texture,
             textures.refer(base.index, base.extensions, base.texCoord, number, "base color texture"));
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
    // Without the texture, all of the surface would shine instead of the part that the texture selects.
    warnings.push_back(fmt::format("material {}: without its emissive texture it does not shine", number));
    material.emissive = glm::vec3(0.0f);
  }
  return done;
}

}  // namespace

Result<void> convertMaterials(const Document& document, Scene& scene) {
  MaterialTextures textures(document, scene);
  MeasuredBrdfs measured(document, scene);
  for (const tinygltf::Material& source : document.model().materials) {
    gltf::Material material = convertMaterial(source);
    if (auto done = addTextures(source, scene.materials.size(), textures, scene.warnings, material); !done)
      return done;
    if (auto done = measured.bind(source, scene.materials.size(), material); !done) return done;
    if (auto done = convertReflection(document, scene.materials.size(), textures, material); !done)
      return done;
    scene.materials.push_back(std::move(material));
  }
  return {};
}

}  // namespace lambent::baker
