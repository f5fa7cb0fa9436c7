// Converts KHR_lights_punctual. mend_lights.cpp has seen to types and ranges.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "baker/import/convert.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;

gltf::Light convertLight(const json& source) {
  gltf::Light light;
  light.name = source.value("name", "");
  const std::string type = source.value("type", "");
  light.type = type == "directional" ? gltf::Light::Type::Directional
               : type == "spot"      ? gltf::Light::Type::Spot
                                     : gltf::Light::Type::Point;
  if (source.contains("color"))
    for (int c = 0; c < 3; ++c) light.color[c] = source["color"][static_cast<std::size_t>(c)].get<float>();
  light.intensity = source.value("intensity", 1.0f);
  // glTF's colours end at 1, so brighter ones are taken as intensity.
  const float largest = std::max({light.color.x, light.color.y, light.color.z});
  if (largest > 1.0f) {
    light.color /= largest;
    light.intensity *= largest;
  }
  light.range_m = source.value("range", 0.0f);
  if (light.type == gltf::Light::Type::Spot) {
    // This is the largest float below a right angle; the next one exceeds pi/2, which glTF forbids.
    const float widest = std::nextafter(std::numbers::pi_v<float> / 2, 0.0f);
    const json& spot = source["spot"];
    light.outer_cone_rad = std::min(spot.value("outerConeAngle", light.outer_cone_rad), widest);
    light.inner_cone_rad =
        std::min(spot.value("innerConeAngle", 0.0f), std::nextafter(light.outer_cone_rad, 0.0f));
  }
  return light;
}

}  // namespace

void convertLights(const Document& document, Scene& scene) {
  const json& root = document.json();
  if (!root.contains("extensions") || !root["extensions"].contains("KHR_lights_punctual")) return;
  const json& extension = root["extensions"]["KHR_lights_punctual"];
  if (!extension.contains("lights")) return;
  for (const json& light : extension["lights"]) scene.lights.push_back(convertLight(light));
}

}  // namespace lambent::baker
