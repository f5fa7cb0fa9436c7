#include <cmath>
#include <numbers>

#include "baker/import/check_fields.hpp"

namespace lambent::baker {
namespace {

std::optional<Object> extension(const Object& object, const char* name) {
  const auto extensions = object.object("extensions");
  return extensions ? extensions->object(name) : std::nullopt;
}

// A finite number, at least `least`; `fallback` where it is missing.
double numberFrom(const Object& object, const char* key, double least, double fallback) {
  const nlohmann::json* value = object.find(key);
  if (value == nullptr) return fallback;
  if (!value->is_number() || !std::isfinite(value->get<float>()) || value->get<double>() < least)
    throw BrokenField{fmt::format("{}: {} is not a number from {} up", object.name, key, least)};
  return value->get<double>();
}

// From 0 to 1, up to a rounding.
void shareFrom(const Object& object, const char* key) {
  if (numberFrom(object, key, 0.0, 1.0) > 1.0 + 1e-4)
    throw BrokenField{fmt::format("{}: {} is more than 1", object.name, key)};
}

void checkLight(const Object& light) {
  light.text("name");
  const std::string type = light.text("type");
  if (type != "directional" && type != "point" && type != "spot")
    throw BrokenField{fmt::format("{} has the unknown type \"{}\"", light.name, type)};
  checkNumbers(light, "color", 3);
  for (const nlohmann::json& value : light.list("color"))
    if (value.get<float>() < 0.0f) throw BrokenField{fmt::format("{}: color is negative", light.name)};
  numberFrom(light, "intensity", 0.0, 1.0);
  if (light.find("range") != nullptr && numberFrom(light, "range", 0.0, 0.0) == 0.0)
    throw BrokenField{fmt::format("{}: range is 0", light.name)};
  if (type != "spot") return;
  const auto spot = light.object("spot");
  if (!spot) throw BrokenField{fmt::format("{} has no spot", light.name)};
  const double inner = numberFrom(*spot, "innerConeAngle", 0.0, 0.0),
               outer = numberFrom(*spot, "outerConeAngle", 0.0, std::numbers::pi / 4);
  // A right angle in float is a little more than one.
  if (!(inner < outer) || outer > std::numbers::pi / 2 + 1e-6)
    throw BrokenField{fmt::format("{}: cones of {} and {} rad are not one inside the other, within pi/2",
                                  spot->name, inner, outer)};
}

}  // namespace

void checkTextureTransform(const Object& texture_info) {
  const auto transform = extension(texture_info, "KHR_texture_transform");
  if (!transform) return;
  checkNumbers(*transform, "offset", 2);
  checkNumbers(*transform, "scale", 2);
  numberFrom(*transform, "rotation", -std::numeric_limits<double>::max(), 0.0);
  transform->number("texCoord");
}

void checkEmissiveStrength(const Object& material) {
  if (const auto strength = extension(material, "KHR_materials_emissive_strength"))
    numberFrom(*strength, "emissiveStrength", 0.0, 1.0);
}

void checkTextureInfo(const Object& owner, const char* key, const Root& root) {
  const auto info = owner.object(key);
  if (!info) return;
  if (!info->index("index", root.size("textures"), "textures"))
    throw BrokenField{fmt::format("{} has no index", info->name)};
  info->number("texCoord");
  checkTextureTransform(*info);
}

void checkReflection(const Object& material, const Root& root) {
  if (const auto pbr = material.object("pbrMetallicRoughness")) {
    shareFrom(*pbr, "metallicFactor");
    shareFrom(*pbr, "roughnessFactor");
    checkTextureInfo(*pbr, "metallicRoughnessTexture", root);
  }
  if (const auto ior = extension(material, "KHR_materials_ior"))
    if (const double value = numberFrom(*ior, "ior", 0.0, 1.5); value != 0.0 && value < 1.0)
      throw BrokenField{fmt::format("{}: ior is {}, neither 0 nor 1 and more", ior->name, value)};
  if (const auto specular = extension(material, "KHR_materials_specular")) {
    shareFrom(*specular, "specularFactor");
    checkNumbers(*specular, "specularColorFactor", 3);
    for (const nlohmann::json& value : specular->list("specularColorFactor"))
      if (value.get<float>() < 0.0f)
        throw BrokenField{fmt::format("{}: specularColorFactor is negative", specular->name)};
    checkTextureInfo(*specular, "specularTexture", root);
    checkTextureInfo(*specular, "specularColorTexture", root);
  }
  if (const auto anisotropy = extension(material, "KHR_materials_anisotropy")) {
    shareFrom(*anisotropy, "anisotropyStrength");
    numberFrom(*anisotropy, "anisotropyRotation", -std::numeric_limits<double>::max(), 0.0);
    checkTextureInfo(*anisotropy, "anisotropyTexture", root);
  }
  // `extras` may be anything; only what stands under our own name is ours.
  const nlohmann::json* extras = material.find("extras");
  if (extras == nullptr || !extras->is_object() || !extras->contains("lambent")) return;
  Object{*extras, material.name + ": extras"}.object("lambent")->text("brdf");
}

void checkLights(const Root& root) {
  const auto lights = extension(root.object, "KHR_lights_punctual");
  if (!lights) return;
  std::size_t i = 0;
  for (const nlohmann::json& light : lights->list("lights")) {
    if (!light.is_object()) throw BrokenField{fmt::format("light {} is not an object", i)};
    checkLight({light, fmt::format("light {}", i++)});
  }
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
