#include "editor/session/field_numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "editor/session/session.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/materials.hpp"

namespace lambent::editor {

namespace {

constexpr std::string_view kFlux = "all light that leaves the lamp, lumen",
                           kIntensity = "light into a direction, candela";

// Integrates the falloff of KHR_lights_punctual between both cones, the square of a line in the cosine.
double solidAngleOfSpot(const scene::LocalLightComponent& light) {
  const double outer = std::cos(double{light.outer_cone_rad}),
               inner =
                   std::max(outer, std::cos(double{std::min(light.inner_cone_rad, light.outer_cone_rad)}));
  return 2.0 * std::numbers::pi * ((1.0 - inner) + (inner - outer) / 3.0);
}

}  // namespace

std::vector<LightUnit> unitsOf(const scene::LocalLightComponent& light) {
  using LightKind = scene::LocalLightComponent::Kind;
  const double area = std::numbers::pi * double{light.radius_m} * double{light.radius_m};
  switch (light.kind) {
    case LightKind::Point:
      return {{"cd", kIntensity, 1.0}, {"lm", kFlux, 4.0 * std::numbers::pi}};
    case LightKind::Spot: {
      std::vector<LightUnit> units = {{"cd", kIntensity, 1.0}};
      if (const double angle = solidAngleOfSpot(light); angle > 0.0) units.push_back({"lm", kFlux, angle});
      return units;
    }
    case LightKind::Directional:
      return {{"lx", "light on a surface that faces it, lux", 1.0}};
    case LightKind::Sphere:
    case LightKind::Disc: {
      std::vector<LightUnit> units = {{"cd/m²", "light of the lamp's surface into a direction", 1.0}};
      if (!(area > 0.0)) return units;
      units.push_back({"cd", kIntensity, area});
      // A Lambertian surface sends pi times its radiance from each side that shines.
      units.push_back(
          {"lm", kFlux, std::numbers::pi * (light.kind == LightKind::Sphere ? 4.0 * area : area)});
      return units;
    }
  }
  return {};
}

LightUnit unitOf(const scene::LocalLightComponent& light, std::string_view name) {
  const std::vector<LightUnit> units = unitsOf(light);
  const auto found = std::ranges::find(units, name, &LightUnit::name);
  return found == units.end() ? units.front() : *found;
}

namespace {

using scene::FieldInfo;
using scene::ValueKind;

constexpr double kDegrees = 180.0 / std::numbers::pi;

bool isAngle(const FieldInfo& field) {
  return field.unit == "rad";
}

// Returns how many of the shown units one of the field's is.
double factorOf(const Session& session, const FieldInfo& field, ecs::Entity entity) {
  if (isAngle(field)) return kDegrees;
  if (!isStrengthOfLight(field)) return 1.0;
  const auto& light = session.document.registry().get<scene::LocalLightComponent>(entity);
  return unitOf(light, session.preferences.light_unit).factor;
}

}  // namespace

bool isStrengthOfLight(const FieldInfo& field) {
  return field.component == scene::LocalLightComponent::kComponentName && field.name == "strength";
}

bool hasNumbers(const FieldInfo& field) {
  // A number of a measured BRDF is chosen by its name.
  if (field.kind == ValueKind::Whole)
    return field.component != scene::MaterialComponent::kComponentName || field.name != "brdf";
  if (field.kind == ValueKind::Vector) return !field.color;
  return field.kind == ValueKind::Number || field.kind == ValueKind::Rotation;
}

std::vector<double> numbersOf(const Session& session, const FieldInfo& field, ecs::Entity entity,
                              const scene::Value& value) {
  if (const auto* number = std::get_if<float>(&value))
    return {double{*number} * factorOf(session, field, entity)};
  if (const auto* whole = std::get_if<std::int32_t>(&value)) return {static_cast<double>(*whole)};
  if (const auto* v = std::get_if<glm::vec3>(&value)) return {double{v->x}, double{v->y}, double{v->z}};
  const auto* rotation = std::get_if<glm::quat>(&value);
  if (!rotation) return {};
  const HeldAngles& held = session.field_edit.angles;
  const bool same = std::abs(glm::dot(held.rotation, *rotation)) > 1.0f - 1e-6f;
  const glm::vec3 degrees = same ? held.degrees : glm::degrees(glm::eulerAngles(*rotation));
  return {double{degrees.x}, double{degrees.y}, double{degrees.z}};
}

scene::Value valueOf(const Session& session, const FieldInfo& field, ecs::Entity entity,
                     const std::vector<double>& numbers) {
  const auto real = [&](std::size_t i) { return static_cast<float>(numbers[i]); };
  if (field.kind == ValueKind::Vector) return glm::vec3(real(0), real(1), real(2));
  if (field.kind == ValueKind::Rotation)
    return glm::normalize(glm::quat(glm::radians(glm::vec3(real(0), real(1), real(2)))));
  auto number = static_cast<float>(numbers[0] / factorOf(session, field, entity));
  if (field.range) number = std::clamp(number, field.range->least, field.range->greatest);
  if (field.kind == ValueKind::Whole) return static_cast<std::int32_t>(std::lround(number));
  return number;
}

double stepOf(const Session& session, const FieldInfo& field, double number) {
  const GizmoOptions& steps = session.handles.gizmo.options;
  if (field.kind == ValueKind::Rotation || isAngle(field)) return double{steps.snap_deg};
  if (field.unit == "m") return double{steps.snap_m};
  if (field.component == scene::Transform::kComponentName && field.name == "scale")
    return double{steps.snap_scale};
  if (field.kind == ValueKind::Whole) return 10.0;
  if (field.range && field.range->greatest - field.range->least <= 10.0f) return 0.1;
  return 0.1 * std::pow(10.0, std::floor(std::log10(std::max(std::abs(number), 0.1))));
}

namespace {

bool isUsed(const scene::LocalLightComponent& light, std::string_view field) {
  using Kind = scene::LocalLightComponent::Kind;
  if (field == "radius") return light.kind == Kind::Sphere || light.kind == Kind::Disc;
  if (field == "range") return light.kind == Kind::Point || light.kind == Kind::Spot;
  if (field == "inner_cone" || field == "outer_cone") return light.kind == Kind::Spot;
  return true;
}

bool isUsed(const scene::CameraComponent& camera, std::string_view field) {
  if (field == "yfov" || field == "aspect") return camera.perspective;
  if (field == "xmag" || field == "ymag") return !camera.perspective;
  return true;
}

}  // namespace

bool isUsed(const ecs::Registry& registry, ecs::Entity entity, const scene::FieldInfo& field) {
  if (field.component == scene::LocalLightComponent::kComponentName)
    return isUsed(registry.get<scene::LocalLightComponent>(entity), field.name);
  if (field.component == scene::CameraComponent::kComponentName)
    return isUsed(registry.get<scene::CameraComponent>(entity), field.name);
  // Only matrices of files have shear; taken apart, others have a rounding error.
  if (field.component == scene::Transform::kComponentName && field.name == "shear")
    return glm::length(registry.get<scene::Transform>(entity).shear) > 1e-6f;
  if (field.component == scene::MaterialComponent::kComponentName && field.name == "anisotropy_rotation")
    return registry.get<scene::MaterialComponent>(entity).anisotropy > 0.0f;
  return true;
}

namespace {

// Returns the number that the text is, with blanks around it.
std::optional<double> numberIn(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == text.npos) return std::nullopt;
  text = text.substr(first, text.find_last_not_of(' ') + 1 - first);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [read, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && read == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

double NumberEdit::appliedTo(double number) const {
  return kind == Kind::Set ? amount : kind == Kind::Add ? number + amount : number * amount;
}

std::optional<NumberEdit> parseNumberEdit(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  if (text.empty()) return std::nullopt;
  const char sign = text.front();
  const bool assigns = text.size() > 1 && text[1] == '=';
  // A number may begin with + or -, but not with * or /.
  const bool relative = sign == '*' || sign == '/' || ((sign == '+' || sign == '-') && assigns);
  const auto value = numberIn(relative ? text.substr(assigns ? 2 : 1) : text);
  if (!value) return std::nullopt;
  if (!relative) return NumberEdit{NumberEdit::Kind::Set, *value};
  if (sign == '/' && *value == 0.0) return std::nullopt;
  if (sign == '+' || sign == '-') return NumberEdit{NumberEdit::Kind::Add, sign == '+' ? *value : -*value};
  return NumberEdit{NumberEdit::Kind::Multiply, sign == '*' ? *value : 1.0 / *value};
}

}  // namespace lambent::editor
