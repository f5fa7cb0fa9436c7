#include "editor/session/local_lights.hpp"

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

}  // namespace lambent::editor
