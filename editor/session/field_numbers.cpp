#include "editor/session/field_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>

#include "editor/session/session.hpp"
#include "runtime/spec/light.hpp"

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

using Kind = scene::LocalLightComponent::Kind;

constexpr float kShareOfWay = 0.35f;  // from the surface towards the camera
constexpr float kRadiusOfDistance = 0.1f;
constexpr float kOfWhite = 0.5f;  // what a white surface that faces the light is shown as
// Where a new directional light stands, seen from the camera: over its shoulder, so that it shows on what the
// camera sees, with shadows to one side.
constexpr float kShoulderDeg = 40.0f, kHighDeg = 50.0f;

// Rounds to two digits, as a person would choose it.
float rounded(float value) {
  if (!(value > 0.0f) || !std::isfinite(value)) return value;
  const float step = std::pow(10.0f, std::floor(std::log10(value)) - 1.0f);
  return step * std::round(value / step);
}

glm::vec3 lookedAt(const Session& session) {
  const Viewing& viewing = session.viewing;
  return (viewing.surface_ahead ? viewing.surface_ahead() : std::nullopt).value_or(viewing.goal.target_ws);
}

// Returns the rotation that takes +Z, from where lights shine, to this direction.
glm::quat facing(float azimuth_deg, float elevation_deg) {
  return glm::angleAxis(glm::radians(azimuth_deg), glm::vec3(0.0f, 1.0f, 0.0f)) *
         glm::angleAxis(-glm::radians(elevation_deg), glm::vec3(1.0f, 0.0f, 0.0f));
}
glm::quat facing(const glm::vec3& direction) {
  return facing(glm::degrees(std::atan2(direction.x, direction.z)),
                glm::degrees(std::asin(std::clamp(direction.y, -1.0f, 1.0f))));
}

void put(EntitySnapshot& snapshot, std::string_view component, std::string_view field, scene::Value value) {
  for (ComponentValues& part : snapshot.components) {
    if (part.component->name != component) continue;
    for (std::size_t i = 0; i < part.values.size(); ++i)
      if (part.component->fields[i].name == field) part.values[i] = std::move(value);
  }
}

// Returns the strength at which a white surface at this distance, facing the light, is seen well.
float strengthFor(Kind kind, float distance_m, float radius_m, float exposure_ev) {
  const float irradiance = std::numbers::pi_v<float> * kOfWhite * std::exp2(-exposure_ev);
  const float intensity = irradiance * distance_m * distance_m;
  switch (kind) {
    case Kind::Directional:
      return irradiance;
    case Kind::Point:
    case Kind::Spot:
      return intensity;
    case Kind::Sphere:
    case Kind::Disc:
      return intensity / (std::numbers::pi_v<float> * radius_m * radius_m);
  }
  return 1.0f;
}

}  // namespace

glm::vec3 newPlace(const Session& session) {
  const glm::vec3 surface = lookedAt(session);
  return surface + kShareOfWay * (session.viewing.goal.eye() - surface);
}

EntitySnapshot newLight(const Session& session, Kind kind, std::string name,
                        const std::optional<glm::vec3>& at) {
  const glm::vec3 place = at.value_or(newPlace(session));
  const glm::vec3 back = place - lookedAt(session);
  const float distance = glm::length(back) > 0.0f ? glm::length(back) : 1.0f;
  const float radius = rounded(kRadiusOfDistance * distance);
  EntitySnapshot light = lightEntity(scene::kLightKindWords[static_cast<std::size_t>(kind)], std::move(name));
  put(light, "Transform", "translation", place);
  if (kind == Kind::Directional)
    put(light, "Transform", "rotation", facing(session.viewing.goal.azimuth_deg + kShoulderDeg, kHighDeg));
  if (kind == Kind::Spot || kind == Kind::Disc) put(light, "Transform", "rotation", facing(back / distance));
  if (kind == Kind::Sphere || kind == Kind::Disc) put(light, "Light", "radius", radius);
  put(light, "Light", "strength", rounded(strengthFor(kind, distance, radius, session.picture.exposure_ev)));
  return light;
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
  switch (field.kind) {
    case ValueKind::Number:
    case ValueKind::Rotation:
      return true;
    case ValueKind::Vector:
      return !field.color;
    case ValueKind::Whole:  // a number of a measured BRDF is chosen by its name
      return field.component != scene::MaterialComponent::kComponentName || field.name != "brdf";
    case ValueKind::Flag:
    case ValueKind::Text:
    case ValueKind::Word:
      break;
  }
  return false;
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

}  // namespace lambent::editor
