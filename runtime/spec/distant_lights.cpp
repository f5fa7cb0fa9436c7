#include "runtime/spec/distant_lights.hpp"

#include <glm/trigonometric.hpp>

#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::spec {

Result<DistantLights> loadDistantLights(
    const std::vector<Light>& lights,
    const std::function<Result<EnvironmentMap>(const EnvironmentMapLight&)>& load) {
  DistantLights out;
  for (const Light& light : lights) {
    if (const auto* constant = std::get_if<ConstantLight>(&light)) {
      out.constant += constant->radiance;
    } else if (const auto* sun = std::get_if<SunLight>(&light)) {
      out.discs.push_back({.direction = directionFromAzimuthElevation(sun->azimuth_deg, sun->elevation_deg),
                           .radius_rad = glm::radians(sun->angle_deg),
                           .radiance = sun->radiance});
    } else if (const auto* file = std::get_if<EnvironmentMapLight>(&light)) {
      Result<EnvironmentMap> environment_map = load(*file);
      if (!environment_map) return failAgain(environment_map.error());
      for (const std::string& notice : environment_map->image.notices)
        out.notices.push_back(file->file.string() + ": " + notice);
      out.environment_maps.push_back(std::move(*environment_map));
    }
  }
  return out;
}

sh::LightVector DistantLights::lightVector() const {
  return skyVector() + discVector(discs);
}

sh::LightVector DistantLights::skyVector() const {
  sh::LightVector light = sh::constantLight(sh::kMaxOrder, constant);
  for (const EnvironmentMap& environment_map : environment_maps)
    light +=
        sh::projectImage(sh::kMaxOrder, environment_map.layout, static_cast<int>(environment_map.image.width),
                         static_cast<int>(environment_map.image.height), environment_map.image.texels);
  return light;
}

sh::LightVector discVector(std::span<const Disc> discs) {
  sh::LightVector light{.order = sh::kMaxOrder};
  for (const Disc& disc : discs)
    light +=
        sh::discLight(sh::kMaxOrder, disc.direction, static_cast<double>(disc.radius_rad), disc.radiance);
  return light;
}

sh::LightVector turned(const sh::LightVector& light, float degrees) {
  const Result<glm::dmat3> rotation = sh::orthonormalised(glm::dmat3(lightRotation(degrees)));
  return rotation ? sh::Rotation(*rotation, light.order).apply(light) : light;
}

}  // namespace lambent::spec
