// Mends materials, and the textures, samplers and images that they use.

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <set>
#include <type_traits>

#include "baker/import/check.hpp"
#include "runtime/bundle/material_fields.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker {

namespace {

using nlohmann::json;
using Allowed = gltf::MaterialJson::Allowed;

void mendTextureInfo(const Entry& owner, const char* key) {
  const auto info = owner.object(key);
  if (!info) return;
  if (!info->index("index", "textures")) return owner.leaveOut(key, "has no index");
  info->keepWhole("texCoord", 255);
  const auto transform = info->extension("KHR_texture_transform");
  if (!transform) return;
  transform->clampAll("offset", 2, -kAnyNumber, kAnyNumber);
  transform->clampAll("scale", 2, -kAnyNumber, kAnyNumber);
  transform->clamp("rotation", -kAnyNumber, kAnyNumber);
  transform->keepWhole("texCoord", 255);
}

void mendNumber(const Entry& place, const gltf::MaterialJson& field) {
  if (field.allowed != Allowed::ZeroOrFromOne)
    return place.clamp(field.key, field.allowed == Allowed::Any ? -kAnyNumber : 0.0,
                       field.allowed == Allowed::ZeroToOne ? 1.0 : kAnyNumber);
  const json* value = place.find(field.key);
  if (value == nullptr) return;
  if (value->is_number() && value->get<double>() < 0.0) return place.leaveOut(field.key, "is negative");
  place.clamp(field.key, *value == 0 ? 0.0 : 1.0, kAnyNumber);
}

std::optional<Entry> placeOf(const Entry& material, const std::array<const char*, 2>& objects) {
  if (!objects[0]) return material;
  const auto place = material.object(objects[0]);
  return place && objects[1] ? place->object(objects[1]) : place;
}

// Mends the members of a material that are read, by the table of its fields.
void mendFields(const Entry& material) {
  gltf::forEachMaterialField([&]<class Row>(const Row& row) {
    using Value = typename Row::Value;
    const auto inPlace = [&](auto mend) {
      if (const auto place = placeOf(material, row.json.objects)) mend(*place);
    };
    if constexpr (std::is_same_v<Value, gltf::TextureRef>)
      inPlace([&](const Entry& place) { mendTextureInfo(place, row.json.key); });
    else if constexpr (std::is_same_v<Value, float>)
      inPlace([&](const Entry& place) { mendNumber(place, row.json); });
    else if constexpr (std::is_same_v<Value, glm::vec3>)
      inPlace([&](const Entry& place) {
        const bool emits = row.part == gltf::MaterialPart::Emission;
        place.clampAll(row.json.key, 3, 0.0, emits ? double{spec::kMostRadiance} : kAnyNumber);
      });
  });
}

void mendColor(const Entry& owner, const char* key) {
  if (json* color = owner.find(key); color != nullptr && color->is_array() && color->size() == 3) {
    color->push_back(1.0);
    owner.warn(fmt::format("{} has no alpha, which counts as 1", key));
  }
  owner.clampAll(key, 4, 0.0, 1.0);
}

void mendSpecularGlossiness(const Entry& material) {
  const auto extension = material.extension("KHR_materials_pbrSpecularGlossiness");
  if (!extension) return;
  mendColor(*extension, "diffuseFactor");
  extension->clampAll("specularFactor", 3, 0.0, 1.0);
  extension->clamp("glossinessFactor", 0.0, 1.0);
  mendTextureInfo(*extension, "diffuseTexture");
  mendTextureInfo(*extension, "specularGlossinessTexture");
}

// Keeps what shines below the most that pictures hold.
void mendEmission(const Entry& material) {
  const auto extension = material.extension("KHR_materials_emissive_strength");
  if (!extension) return;
  double largest = 0.0;
  if (const json* color = material.find("emissiveFactor"))
    for (const json& value : *color) largest = std::max(largest, value.get<double>());
  extension->clamp("emissiveStrength", 0.0,
                   largest > 0.0 ? double{spec::kMostRadiance} / largest : kAnyNumber);
}

void mendAlphaMode(const Entry& material) {
  json* mode = material.find("alphaMode");
  if (mode == nullptr) return;
  std::string word = mode->is_string() ? mode->get<std::string>() : std::string();
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::toupper(c); });
  if (word != "OPAQUE" && word != "MASK" && word != "BLEND")
    return material.leaveOut("alphaMode", fmt::format("is {}", mode->dump()));
  if (*mode != json(word)) material.warn(fmt::format("alphaMode {} counts as {}", mode->dump(), word));
  *mode = word;
}

void mendFlag(const Entry& material, const char* key) {
  const json* flag = material.find(key);
  if (flag == nullptr || flag->is_boolean()) return;
  const bool set = *flag == 1 || *flag == "true";
  material.warn(fmt::format("{} is {}, which counts as {}", key, flag->dump(), set));
  material.json[key] = set;
}

void mendConstant(const Entry& sampler, const char* key, std::initializer_list<std::uint64_t> known) {
  const json* value = sampler.find(key);
  if (value == nullptr) return;
  if (!value->is_number_unsigned() || std::ranges::find(known, value->get<std::uint64_t>()) == known.end())
    sampler.leaveOut(key, fmt::format("is {}", value->dump()));
}

void mendSampler(const Entry& sampler) {
  constexpr std::uint64_t kClamp = 10496, kClampToBorder = 33069, kClampToEdge = 33071,
                          kMirroredRepeat = 33648, kRepeat = 10497;
  for (const char* key : {"wrapS", "wrapT"}) {
    if (json* wrap = sampler.find(key); wrap != nullptr && (*wrap == kClamp || *wrap == kClampToBorder)) {
      sampler.warn(fmt::format("{} is {}, which counts as {}", key, wrap->dump(), kClampToEdge));
      *wrap = kClampToEdge;
    }
    mendConstant(sampler, key, {kClampToEdge, kMirroredRepeat, kRepeat});
  }
  mendConstant(sampler, "magFilter", {9728, 9729});
  mendConstant(sampler, "minFilter", {9728, 9729, 9984, 9985, 9986, 9987});
}

// Leaves an image either a URI or a view, or neither if it names nothing.
void mendImage(const Entry& image) {
  for (const char* key : {"uri", "mimeType"})
    if (const json* text = image.find(key); text != nullptr && !text->is_string())
      image.leaveOut(key, "is not a string");
  if (image.find("uri") != nullptr && image.find("bufferView") != nullptr)
    image.leaveOut("uri", "stands beside a bufferView");
}

}  // namespace

void mendMaterials(const Entry& root) {
  root.forEach("images", "image", mendImage);
  root.forEach("samplers", "sampler", mendSampler);
  root.forEach("materials", "material", [](const Entry& material) {
    mendFields(material);
    if (const auto pbr = material.object("pbrMetallicRoughness")) mendColor(*pbr, "baseColorFactor");
    mendSpecularGlossiness(material);
    mendEmission(material);
    mendAlphaMode(material);
    mendFlag(material, "doubleSided");
    material.json.erase("occlusionTexture");  // nothing reads it
    if (const auto ours = material.ours()) ours->text("brdf");
  });
}

// Mends punctual lights and cameras.

namespace {

// Returns a number, or `fallback` if there is none.
double numberOf(const Entry& entry, const char* key, double fallback) {
  const json* value = entry.find(key);
  return value != nullptr && value->is_number() ? value->get<double>() : fallback;
}

void mendCones(const Entry& light) {
  if (!light.object("spot")) {
    light.warn("it has no spot, so its cone is that of the default");
    light.json["spot"] = json::object();
  }
  // A cone without width would give no light.
  constexpr double kThinnest_rad = 1e-3, kRightAngle_rad = std::numbers::pi / 2;
  const Entry spot = *light.object("spot");
  spot.clamp("outerConeAngle", kThinnest_rad, kRightAngle_rad);
  // Exporters write equal cones for a hard edge.
  const double outer = numberOf(spot, "outerConeAngle", std::numbers::pi / 4);
  spot.clamp("innerConeAngle", 0.0, outer);
}

void mendLight(const Entry& light) {
  light.clamp("intensity", 0.0, double{spec::kMostRadiance});
  light.clampAll("color", 3, 0.0, double{spec::kMostRadiance});
  double largest = 1.0;
  if (const json* color = light.find("color"))
    for (const json& value : *color) largest = std::max(largest, value.get<double>());
  light.clamp("intensity", 0.0, double{spec::kMostRadiance} / largest);
  if (const double range = numberOf(light, "range", 1.0); !(range > 0.0))
    light.leaveOut("range", fmt::format("is {:g}, which counts as no limit,", range));
  light.clamp("range", 0.0, kAnyNumber);
  if (light.json["type"] == "spot") mendCones(light);
}

void mendCamera(const Entry& camera) {
  if (const json* type = camera.find("type");
      type == nullptr || (*type != "perspective" && *type != "orthographic")) {
    const char* kind = camera.find("orthographic") ? "orthographic" : "perspective";
    camera.warn(fmt::format("its type is not known, so it counts as {}", kind));
    camera.json["type"] = kind;
  }
  const bool perspective = camera.json["type"] == "perspective";
  const char* kind = perspective ? "perspective" : "orthographic";
  if (!camera.object(kind)) camera.json[kind] = json::object();
  const Entry lens = *camera.object(kind);
  // Replaces a number that no lens has, or leaves it out if it may be missing.
  const auto mend = [&](const char* key, std::optional<double> now, auto good) {
    const json* value = lens.find(key);
    if (value == nullptr ? !now : isFiniteNumber(*value) && good(value->get<float>())) return;
    if (!now) return lens.leaveOut(key, fmt::format("is {}", value->dump()));
    lens.warn(fmt::format("{} is {}, which counts as {:g}", key, value ? value->dump() : "missing", *now));
    lens.json[key] = *now;
  };
  const auto positive = [](float v) { return v > 0.0f; };
  const auto any = [](float v) { return v != 0.0f; };
  if (perspective) {
    mend("yfov", 0.8, [](float v) { return v > 0.0f && v < std::numbers::pi_v<float>; });
    mend("znear", 0.01, positive);
    mend("aspectRatio", std::nullopt, positive);
  } else {
    mend("xmag", 1.0, any);
    mend("ymag", 1.0, any);
    mend("znear", 0.0, [](float v) { return v >= 0.0f; });
  }
  const auto near = static_cast<float>(numberOf(lens, "znear", 0.0));
  mend("zfar", std::nullopt, [&](float v) { return v > near; });
}

}  // namespace

void mendLights(const Entry& root) {
  const auto extension = root.extension("KHR_lights_punctual");
  if (!extension) return;
  std::set<std::size_t> unknown;
  std::size_t number = 0;
  extension->forEach("lights", "light", [&](const Entry& light) {
    const json* type = light.find("type");
    const bool known = type != nullptr && (*type == "directional" || *type == "point" || *type == "spot");
    if (!known) {
      light.warn(fmt::format("its type {} is not known, so it does not shine",
                             type ? type->dump() : "is missing and"));
      unknown.insert(number);
      light.json["type"] = "point";
    }
    mendLight(light);
    ++number;
  });
  root.forEach("nodes", "node", [&](const Entry& node) {
    const auto use = node.extension("KHR_lights_punctual");
    const json* light = use ? use->find("light") : nullptr;
    if (use &&
        (light == nullptr || (light->is_number_unsigned() && unknown.contains(light->get<std::size_t>()))))
      node.json["extensions"].erase("KHR_lights_punctual");
  });
}

void mendCameras(const Entry& root) {
  root.forEach("cameras", "camera", mendCamera);
}

}  // namespace lambent::baker
