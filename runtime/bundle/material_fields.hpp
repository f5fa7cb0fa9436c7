// The table of a material's fields has one row for each member of gltf::Material. Code that needs all fields
// walks this table instead of naming them: the JSON of bundles, the digests of a scene and of a reference
// picture, the keys of baked results, edits of a scene, the component in the inspector, and the rules that
// say when a material must be baked again. To add a field, add a member of Material and a row here. If the
// field can be changed while it is shown, add a member of MaterialFactors as well.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "runtime/bundle/gltf_types.hpp"

namespace lambent::gltf {

// Tells which results of a bake depend on a field.
enum class MaterialPart : std::uint8_t {
  Name,
  Color,       // bounced light
  Reflection,  // transfer and kernels of glossy surfaces, and the light that they bounce
  Emission,    // lights of a group, up to a factor that can change at run time
  Relief,      // only the tangents of glossy surfaces, since normal maps are applied at run time
  Opacity,     // rays that a surface stops or weakens
};

// Tells where a field stands in glTF's JSON.
struct MaterialJson {
  enum class Allowed : std::uint8_t { Any, ZeroToOne, NotNegative, ZeroOrFromOne };

  std::array<const char*, 2> objects{};  // objects around the key, the outer one first; null if there is none
  const char* key = nullptr;             // if null, the presence of the object means "true"
  Allowed allowed = Allowed::Any;
  bool required = false;                    // true if the key must be present whenever its object is
  bool (*said)(const Material&) = nullptr;  // whether to write it; if null, it is written unless default
};

// Describes a member of MaterialFactors as a value of the field that it belongs to.
template <class T>
struct LiveValue {
  struct Range {
    T least, greatest;
  };
  std::string_view name;  // name in the inspector, in scripts and in world files, so it must not change
  T MaterialFactors::*factor;
  const char* edit;  // name in the JSON of edits, which must not change either; null if it has no edit
  std::optional<Range> range{};
  std::string_view unit{};
};

// Describes a row of the table. T is the type of the member. Live are the types of its live values; most rows
// have none, or one of type T.
template <class T, class... Live>
struct MaterialField {
  using Value = T;

  std::string_view name;  // name of the member
  T Material::*member;
  MaterialPart part;
  MaterialJson json;
  std::tuple<LiveValue<Live>...> live{};
  bool color_texture = false;  // true for textures that are sRGB colours instead of linear numbers
};

namespace material_rows {

using M = Material;
using F = MaterialFactors;
using Part = MaterialPart;
using Allowed = MaterialJson::Allowed;
using Range = LiveValue<float>::Range;
using Objects = std::array<const char*, 2>;

inline constexpr float kTurn = 2.0f * std::numbers::pi_v<float>;
inline constexpr Range kZeroToOne{0.0f, 1.0f};
inline constexpr Objects kTop = {};
inline constexpr Objects kPbr = {"pbrMetallicRoughness"};
inline constexpr Objects kIor = {"extensions", "KHR_materials_ior"};
inline constexpr Objects kSpecular = {"extensions", "KHR_materials_specular"};
inline constexpr Objects kAnisotropy = {"extensions", "KHR_materials_anisotropy"};
inline constexpr Objects kTransmission = {"extensions", "KHR_materials_transmission"};
inline constexpr Objects kVolume = {"extensions", "KHR_materials_volume"};
inline constexpr Objects kUnlit = {"extensions", "KHR_materials_unlit"};
inline constexpr bool kRequired = true, kColor = true;

constexpr bool always(const M&) {
  return true;
}
inline bool emits(const M& m) {
  return m.emissive.x > 0.0f || m.emissive.y > 0.0f || m.emissive.z > 0.0f;
}
inline bool emitsByTexture(const M& m) {
  return emits(m) && m.emissive_texture.texture >= 0;
}
inline bool mapsNormals(const M& m) {
  return m.normal_texture.texture >= 0;
}
inline bool masks(const M& m) {
  return m.alpha_mode == AlphaMode::Mask;
}

template <class T, class... Live>
constexpr MaterialField<T, Live...> row(std::string_view name, T M::*member, Part part, MaterialJson json,
                                        LiveValue<Live>... live) {
  return {name, member, part, json, {live...}};
}
constexpr MaterialField<TextureRef> texture(std::string_view name, TextureRef M::*member, Part part,
                                            MaterialJson json, bool color = false) {
  return {name, member, part, json, {}, color};
}
template <class T>
constexpr LiveValue<T> live(std::string_view name, T F::*factor, const char* edit,
                            std::optional<typename LiveValue<T>::Range> range = {},
                            std::string_view unit = {}) {
  return {name, factor, edit, range, unit};
}

}  // namespace material_rows

// The scene's digest adds the fields in this order, so moving a row invalidates every bundle.
inline constexpr auto kMaterialFields = [] {
  using namespace material_rows;
  return std::tuple{
      row("name", &M::name, Part::Name, {kTop, "name"}),
      row("base_color", &M::base_color, Part::Color,
          {kPbr, "baseColorFactor", Allowed::Any, kRequired, &always},
          live("base_color", &F::base_color, "baseColor"), live("alpha", &F::alpha, "alpha", kZeroToOne)),
      texture("base_color_texture", &M::base_color_texture, Part::Color, {kPbr, "baseColorTexture"}, kColor),
      row("metallic", &M::metallic, Part::Reflection,
          {kPbr, "metallicFactor", Allowed::ZeroToOne, kRequired, &always},
          live("metallic", &F::metallic, "metallic", kZeroToOne)),
      row("roughness", &M::roughness, Part::Reflection,
          {kPbr, "roughnessFactor", Allowed::ZeroToOne, kRequired, &always},
          live("roughness", &F::roughness, "roughness", kZeroToOne)),
      row("ior", &M::ior, Part::Reflection, {kIor, "ior", Allowed::ZeroOrFromOne, kRequired},
          live("ior", &F::ior, "ior", Range{0.0f, 100.0f})),
      texture("metallic_roughness_texture", &M::metallic_roughness_texture, Part::Reflection,
              {kPbr, "metallicRoughnessTexture"}),
      row("specular", &M::specular, Part::Reflection, {kSpecular, "specularFactor", Allowed::ZeroToOne},
          live("specular", &F::specular, "specular", kZeroToOne)),
      row("specular_color", &M::specular_color, Part::Reflection,
          {kSpecular, "specularColorFactor", Allowed::NotNegative},
          live("specular_color", &F::specular_color, "specularColor")),
      texture("specular_texture", &M::specular_texture, Part::Reflection, {kSpecular, "specularTexture"}),
      texture("specular_color_texture", &M::specular_color_texture, Part::Reflection,
              {kSpecular, "specularColorTexture"}, kColor),
      row("anisotropy", &M::anisotropy, Part::Reflection,
          {kAnisotropy, "anisotropyStrength", Allowed::ZeroToOne},
          live("anisotropy", &F::anisotropy, "anisotropy", kZeroToOne)),
      row("anisotropy_rotation_rad", &M::anisotropy_rotation_rad, Part::Reflection,
          {kAnisotropy, "anisotropyRotation"},
          live("anisotropy_rotation", &F::anisotropy_rotation_rad, "anisotropyRotation", Range{-kTurn, kTurn},
               "rad")),
      texture("anisotropy_texture", &M::anisotropy_texture, Part::Reflection,
              {kAnisotropy, "anisotropyTexture"}),
      row("brdf", &M::brdf, Part::Reflection, {{"extras", "lambent"}, "brdf"},
          live("brdf", &F::brdf, "brdf", LiveValue<std::int32_t>::Range{-1, 65535})),
      row("emissive", &M::emissive, Part::Emission,
          {kTop, "emissiveFactor", Allowed::Any, !kRequired, &emits},
          live("emission", &F::emission, "emissive"),
          live("emission_strength", &F::emission_strength, nullptr, Range{0.0f, 1e6f})),
      texture("emissive_texture", &M::emissive_texture, Part::Emission,
              {kTop, "emissiveTexture", Allowed::Any, !kRequired, &emitsByTexture}, kColor),
      texture("normal_texture", &M::normal_texture, Part::Relief, {kTop, "normalTexture"}),
      row("normal_scale", &M::normal_scale, Part::Relief,
          {{"normalTexture"}, "scale", Allowed::Any, kRequired, &mapsNormals},
          live("normal_scale", &F::normal_scale, "normalScale", Range{-100.0f, 100.0f})),
      row("unlit", &M::unlit, Part::Color, {kUnlit, nullptr}),
      row("alpha_mode", &M::alpha_mode, Part::Opacity, {kTop, "alphaMode"}),
      row("alpha_cutoff", &M::alpha_cutoff, Part::Opacity,
          {kTop, "alphaCutoff", Allowed::Any, !kRequired, &masks},
          live("alpha_cutoff", &F::alpha_cutoff, "alphaCutoff", kZeroToOne)),
      row("double_sided", &M::double_sided, Part::Opacity, {kTop, "doubleSided"}),
      row("transmission", &M::transmission, Part::Opacity,
          {kTransmission, "transmissionFactor", Allowed::ZeroToOne}),
      texture("transmission_texture", &M::transmission_texture, Part::Opacity,
              {kTransmission, "transmissionTexture"}),
      row("thickness_m", &M::thickness_m, Part::Opacity, {kVolume, "thicknessFactor", Allowed::NotNegative}),
      row("attenuation_distance_m", &M::attenuation_distance_m, Part::Opacity,
          {kVolume, "attenuationDistance", Allowed::NotNegative}),
      row("attenuation_color", &M::attenuation_color, Part::Opacity,
          {kVolume, "attenuationColor", Allowed::NotNegative})};
}();

// Calls visit(field) for each row.
template <class Visit>
constexpr void forEachMaterialField(Visit&& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, kMaterialFields);
}

// Calls visit(field) for each row whose value is a texture.
template <class Visit>
constexpr void forEachMaterialTexture(Visit&& visit) {
  forEachMaterialField([&](const auto& field) {
    if constexpr (std::is_same_v<typename std::remove_cvref_t<decltype(field)>::Value, TextureRef>)
      visit(field);
  });
}

// Calls visit(field) for each row except the name and the textures.
template <class Visit>
constexpr void forEachMaterialValue(Visit&& visit) {
  forEachMaterialField([&](const auto& field) {
    using Value = typename std::remove_cvref_t<decltype(field)>::Value;
    if constexpr (!std::is_same_v<Value, TextureRef> && !std::is_same_v<Value, std::string>) visit(field);
  });
}

// Calls visit(field, live) for each value that can be changed while the material is shown.
template <class Visit>
constexpr void forEachLiveValue(Visit&& visit) {
  forEachMaterialField([&](const auto& field) {
    std::apply([&](const auto&... live) { (visit(field, live), ...); }, field.live);
  });
}

// Reads a live value from its field. A colour with alpha has two live values. A strength reads as 1, because
// the field already contains it.
template <class Live, class Value>
Live liveFrom(const Value& value) {
  if constexpr (std::is_same_v<Live, Value>)
    return value;
  else if constexpr (std::is_same_v<Value, glm::vec4> && std::is_same_v<Live, glm::vec3>)
    return glm::vec3(value);
  else if constexpr (std::is_same_v<Value, glm::vec4>)
    return value.a;
  else
    return Live{1};
}

// Puts a live value into its field. A strength must be put after the value that it scales.
template <class Live, class Value>
void putLive(const Live& live, Value& value) {
  if constexpr (std::is_same_v<Live, Value>)
    value = live;
  else if constexpr (std::is_same_v<Value, glm::vec4> && std::is_same_v<Live, glm::vec3>)
    value = glm::vec4(live, value.a);
  else if constexpr (std::is_same_v<Value, glm::vec4>)
    value.a = live;
  else
    value = live * value;
}

inline MaterialFactors factorsOf(const Material& material) {
  MaterialFactors factors;
  forEachLiveValue([&]<class T>(const auto& field, const LiveValue<T>& live) {
    factors.*live.factor = liveFrom<T>(material.*field.member);
  });
  return factors;
}

inline Material withFactors(Material material, const MaterialFactors& factors) {
  forEachLiveValue(
      [&](const auto& field, const auto& live) { putLive(factors.*live.factor, material.*field.member); });
  return material;
}

}  // namespace lambent::gltf
