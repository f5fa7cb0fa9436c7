#include "editor/session/field_numbers.hpp"

#include <algorithm>
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
  if (field.kind == ValueKind::Vector) return !field.color;
  return field.kind == ValueKind::Number || field.kind == ValueKind::Rotation;
}

std::vector<double> numbersOf(const Session& session, const FieldInfo& field, ecs::Entity entity,
                              const scene::Value& value) {
  if (const auto* number = std::get_if<float>(&value))
    return {double{*number} * factorOf(session, field, entity)};
  if (const auto* v = std::get_if<glm::vec3>(&value)) return {double{v->x}, double{v->y}, double{v->z}};
  const auto* rotation = std::get_if<glm::quat>(&value);
  if (!rotation) return {};
  const auto held = std::ranges::find_if(session.angles, [&](const HeldAngles& angles) {
    return std::abs(glm::dot(angles.rotation, *rotation)) > 1.0f - 1e-6f;
  });
  const glm::vec3 degrees =
      held != session.angles.end() ? held->degrees : glm::degrees(glm::eulerAngles(*rotation));
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
  return number;
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

}  // namespace lambent::editor
