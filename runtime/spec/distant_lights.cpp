#include "runtime/spec/distant_lights.hpp"

#include <glm/trigonometric.hpp>

#include "runtime/sh/projection.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/rotate.hpp"

namespace lambent::spec {

Result<DistantLights> loadDistantLights(const std::vector<Light>& lights,
                                        const std::function<Result<Probe>(const ProbeLight&)>& load) {
  DistantLights out;
  for (const Light& light : lights) {
    if (const auto* constant = std::get_if<ConstantLight>(&light)) {
      out.constant += constant->radiance;
    } else if (const auto* sun = std::get_if<SunLight>(&light)) {
      out.discs.push_back({.direction = directionFromAzimuthElevation(sun->azimuth_deg, sun->elevation_deg),
                           .radius_rad = glm::radians(sun->angle_deg),
                           .radiance = sun->radiance});
    } else if (const auto* file = std::get_if<ProbeLight>(&light)) {
      Result<Probe> probe = load(*file);
      if (!probe) return failAgain(probe.error());
      if (probe->texels_not_finite > 0)
        out.notices.push_back(file->file.string() + ": " + std::to_string(probe->texels_not_finite) +
                              " texels are not finite and count as black");
      out.probes.push_back(std::move(*probe));
    }
  }
  return out;
}

sh::LightVector DistantLights::lightVector() const {
  return skyVector() + discVector(discs);
}

sh::LightVector DistantLights::skyVector() const {
  sh::LightVector light = sh::constantLight(sh::kMaxOrder, constant);
  for (const Probe& probe : probes)
    light += sh::projectImage(sh::kMaxOrder, probe.layout, static_cast<int>(probe.image.width),
                              static_cast<int>(probe.image.height), probe.image.texels);
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
