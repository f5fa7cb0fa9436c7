#include <algorithm>
#include <array>

#include "baker/import/check.hpp"
#include "baker/import/check_fields.hpp"
#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker {
namespace {

std::optional<Object> extension(const Object& object, const char* name) {
  const auto extensions = object.object("extensions");
  return extensions ? extensions->object(name) : std::nullopt;
}

// Returns the object that contains a field of a material, if there is one.
std::optional<Object> placeOf(const Object& material, const gltf::MaterialJson& field) {
  const auto [outer, inner] = field.objects;
  if (!outer) return material;
  const auto place = material.object(outer);
  return place && inner ? place->object(inner) : place;
}

void checkTexture(const Object& owner, const char* key, const Root& root) {
  if (const auto info = owner.object(key)) info->index("index", root.size("textures"), "textures");
}

}  // namespace

bool readsExtension(std::string_view name) {
  // Textures of the last four are read if their image can be decoded, and have warnings of their own.
  constexpr std::array<std::string_view, 12> kBesideMaterials{"KHR_draco_mesh_compression",
                                                              "KHR_mesh_quantization",
                                                              "KHR_texture_transform",
                                                              "EXT_meshopt_compression",
                                                              "EXT_mesh_gpu_instancing",
                                                              "KHR_lights_punctual",
                                                              "KHR_materials_emissive_strength",
                                                              "KHR_materials_pbrSpecularGlossiness",
                                                              "EXT_texture_webp",
                                                              "EXT_texture_avif",
                                                              "MSFT_texture_dds",
                                                              "KHR_texture_basisu"};
  bool found = std::ranges::find(kBesideMaterials, name) != kBesideMaterials.end();
  gltf::forEachMaterialField([&](const auto& row) {
    const auto [outer, inner] = row.json.objects;
    found |= inner != nullptr && outer == std::string_view("extensions") && inner == name;
  });
  return found;
}

void checkMaterial(const Object& material, const Root& root) {
  gltf::forEachMaterialTexture([&](const auto& row) {
    if (const auto place = placeOf(material, row.json)) checkTexture(*place, row.json.key, root);
  });
  if (const auto glossiness = extension(material, "KHR_materials_pbrSpecularGlossiness"))
    for (const char* key : {"diffuseTexture", "specularGlossinessTexture"})
      checkTexture(*glossiness, key, root);
  // `extras` may be anything; only what stands under our own name is ours.
  const nlohmann::json* extras = material.find("extras");
  if (extras == nullptr || !extras->is_object() || !extras->contains("lambent")) return;
  if (const nlohmann::json& ours = (*extras)["lambent"]; ours.is_object())
    Object{ours, material.name + ": extras: lambent"}.text("brdf");
}

void checkNodeExtensions(const Object& node, const Root& root) {
  if (const auto light = extension(node, "KHR_lights_punctual")) {
    const auto lights = extension(root.object, "KHR_lights_punctual");
    if (!light->index("light", lights ? lights->list("lights").size() : 0, "lights"))
      throw BrokenField{fmt::format("{} names no light", light->name)};
  }
  if (const auto instances = extension(node, "EXT_mesh_gpu_instancing")) {
    const auto attributes = instances->object("attributes");
    if (!attributes) throw BrokenField{fmt::format("{} has no attributes", instances->name)};
    for (const auto& item : attributes->json.items())
      attributes->index(item.key().c_str(), root.size("accessors"), "accessors");
  }
}

}  // namespace lambent::baker
