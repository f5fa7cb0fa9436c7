#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "baker/import/check.hpp"
#include "baker/import/check_fields.hpp"
#include "runtime/bundle/material_fields.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker {
namespace {

std::optional<Object> extension(const Object& object, const char* name) {
  const auto extensions = object.object("extensions");
  return extensions ? extensions->object(name) : std::nullopt;
}

// Returns a finite number of at least `least`, or `fallback` if it is missing.
double numberFrom(const Object& object, const char* key, double least, double fallback) {
  const nlohmann::json* value = object.find(key);
  if (value == nullptr) return fallback;
  if (!value->is_number() || !std::isfinite(value->get<float>()) || value->get<double>() < least)
    throw BrokenField{fmt::format("{}: {} is not a number from {} up", object.name, key, least)};
  return value->get<double>();
}

// Requires that a colour times a factor is light, and no more of it than pictures hold.
void checkLightOf(const Object& object, const char* color, double factor, const char* what) {
  checkNumbers(object, color, 3);
  double most = factor;
  for (const nlohmann::json& value : object.list(color)) {
    if (value.get<float>() < 0.0f) throw BrokenField{fmt::format("{}: {} is negative", object.name, color)};
    most = std::max(most, factor * value.get<double>());
  }
  if (most > double{spec::kMostRadiance})
    throw BrokenField{fmt::format("{} {} {}", object.name, what, most),
                      fmt::format("the most is {}", spec::kMostRadiance)};
}

// Requires a number from 0 to 1, up to rounding.
void shareFrom(const Object& object, const char* key) {
  if (numberFrom(object, key, 0.0, 1.0) > 1.0 + 1e-4)
    throw BrokenField{fmt::format("{}: {} is more than 1", object.name, key)};
}

// Returns the object that contains a field of a material, if there is one.
std::optional<Object> placeOf(const Object& material, const gltf::MaterialJson& json) {
  const auto [outer, inner] = json.objects;
  if (!outer) return material;
  const auto place = material.object(outer);
  return place && inner ? place->object(inner) : place;
}

// Checks a number against the range that its row allows.
void checkFactor(const Object& place, const gltf::MaterialJson& json, float) {
  using Allowed = gltf::MaterialJson::Allowed;
  if (json.allowed == Allowed::ZeroToOne) return shareFrom(place, json.key);
  const double least = json.allowed == Allowed::Any ? std::numeric_limits<double>::lowest() : 0.0;
  const double value = numberFrom(place, json.key, least, 0.0);
  if (json.allowed == Allowed::ZeroOrFromOne && value != 0.0 && value < 1.0)
    throw BrokenField{fmt::format("{}: {} is {}, neither 0 nor 1 and more", place.name, json.key, value)};
}

// Does the same for a colour.
void checkFactor(const Object& place, const gltf::MaterialJson& json, const glm::vec3&) {
  checkNumbers(place, json.key, 3);
  if (json.allowed != gltf::MaterialJson::Allowed::NotNegative) return;
  for (const nlohmann::json& value : place.list(json.key))
    if (value.get<float>() < 0.0f) throw BrokenField{fmt::format("{}: {} is negative", place.name, json.key)};
}

void checkLight(const Object& light) {
  light.text("name");
  const std::string type = light.text("type");
  if (type != "directional" && type != "point" && type != "spot")
    throw BrokenField{fmt::format("{} has the unknown type \"{}\"", light.name, type)};
  checkLightOf(light, "color", numberFrom(light, "intensity", 0.0, 1.0), "has an intensity of");
  if (light.find("range") != nullptr && numberFrom(light, "range", 0.0, 0.0) == 0.0)
    throw BrokenField{fmt::format("{}: range is 0", light.name)};
  if (type != "spot") return;
  const auto spot = light.object("spot");
  if (!spot) throw BrokenField{fmt::format("{} has no spot", light.name)};
  const double inner = numberFrom(*spot, "innerConeAngle", 0.0, 0.0),
               outer = numberFrom(*spot, "outerConeAngle", 0.0, std::numbers::pi / 4);
  // A right angle in float is slightly more than pi/2.
  if (!(inner < outer) || outer > std::numbers::pi / 2 + 1e-6)
    throw BrokenField{fmt::format("{}: cones of {} and {} rad are not one inside the other, within pi/2",
                                  spot->name, inner, outer)};
}

}  // namespace

bool readsExtension(std::string_view name) {
  constexpr std::array<std::string_view, 7> kBesideMaterials{
      "KHR_draco_mesh_compression",     "KHR_mesh_quantization",   "KHR_texture_transform",
      "EXT_meshopt_compression",        "EXT_mesh_gpu_instancing", "KHR_lights_punctual",
      "KHR_materials_emissive_strength"};
  bool found = std::ranges::find(kBesideMaterials, name) != kBesideMaterials.end();
  gltf::forEachMaterialField([&](const auto& row) {
    const auto [outer, inner] = row.json.objects;
    found |= inner != nullptr && outer == std::string_view("extensions") && inner == name;
  });
  return found;
}

void checkTextureTransform(const Object& texture_info) {
  const auto transform = extension(texture_info, "KHR_texture_transform");
  if (!transform) return;
  checkNumbers(*transform, "offset", 2);
  checkNumbers(*transform, "scale", 2);
  numberFrom(*transform, "rotation", -std::numeric_limits<double>::max(), 0.0);
  transform->number("texCoord");
}

void checkEmission(const Object& material) {
  const auto strength = extension(material, "KHR_materials_emissive_strength");
  checkLightOf(material, "emissiveFactor",
               strength ? numberFrom(*strength, "emissiveStrength", 0.0, 1.0) : 1.0, "emits");
}

void checkTextureInfo(const Object& owner, const char* key, const Root& root) {
  const auto info = owner.object(key);
  if (!info) return;
  if (!info->index("index", root.size("textures"), "textures"))
    throw BrokenField{fmt::format("{} has no index", info->name)};
  info->number("texCoord");
  checkTextureTransform(*info);
}

void checkMaterialFields(const Object& material, const Root& root) {
  gltf::forEachMaterialField([&]<class Row>(const Row& row) {
    using Value = typename Row::Value;
    constexpr bool texture = std::is_same_v<Value, gltf::TextureRef>,
                   factor = std::is_same_v<Value, float> || std::is_same_v<Value, glm::vec3>;
    if constexpr (texture || factor) {
      if (factor && row.part != gltf::MaterialPart::Reflection) return;
      const auto place = placeOf(material, row.json);
      if (!place) return;
      if constexpr (texture)
        checkTextureInfo(*place, row.json.key, root);
      else
        checkFactor(*place, row.json, Value{});
    }
  });
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
