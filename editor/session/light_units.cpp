#include "editor/session/light_units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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
      units.push_back({"lm", kFlux, std::numbers::pi * (light.kind == LightKind::Sphere ? 4.0 * area : area)});
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

}  // namespace lambent::editor
