// Changes each field of a material in turn, so that a test can walk the table of fields and check that each
// one has an effect. The initial material has all that a field may need to have an effect: a normal map, a
// mask, emission.
#pragma once

#include <string>
#include <type_traits>

#include "runtime/bundle/material_fields.hpp"

namespace lambent::testing {

inline constexpr std::size_t kMaterialTextures = 2;

inline gltf::Material materialWithEverything() {
  gltf::Material material;
  material.name = "everything";
  gltf::forEachMaterialTexture([&](const auto& field) { (material.*field.member).texture = 0; });
  material.metallic = 0.5f, material.roughness = 0.5f, material.specular = 0.5f;
  material.anisotropy = 0.5f;
  material.emissive = {0.25f, 0.5f, 0.75f};
  material.alpha_mode = gltf::AlphaMode::Mask;
  return material;
}

inline void change(std::string& value) {
  value += " else";
}
inline void change(gltf::TextureRef& value) {
  value.texture = 1;
}
inline void change(gltf::AlphaMode& value) {
  value = gltf::AlphaMode::Blend;
}
inline void change(std::int32_t& value) {
  ++value;
}
inline void change(bool& value) {
  value = !value;
}
inline void change(float& value) {  // stays in 0..1, or a valid index of refraction
  value = value > 1.0f ? value + 0.25f : value == 0.5f ? 0.625f : 0.5f;
}
template <glm::length_t L>
void change(glm::vec<L, float>& value) {
  value = 0.5f * value + glm::vec<L, float>(0.125f);
}

// Returns the material with another value in one field.
template <class Field>
gltf::Material changed(gltf::Material material, const Field& field) {
  change(material.*field.member);
  return material;
}

}  // namespace lambent::testing
