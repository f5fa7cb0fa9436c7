#include "runtime/lighting/environment.hpp"

#include <fmt/format.h>
#include <glm/trigonometric.hpp>

#include "runtime/sh/projection.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/rotate.hpp"

namespace lambent::lighting {

Result<Environment> Environment::create(const std::vector<spec::Light>& lights) {
  Environment environment;
  environment.unturned_.order = sh::kMaxOrder;
  for (const spec::Light& light : lights) {
    if (const auto* constant = std::get_if<spec::ConstantLight>(&light)) {
      environment.constant_ += constant->radiance;
      environment.unturned_ += sh::constantLight(sh::kMaxOrder, constant->radiance);
    } else if (const auto* sun = std::get_if<spec::SunLight>(&light)) {
      const Disc disc{.direction = spec::directionFromAzimuthElevation(sun->azimuth_deg, sun->elevation_deg),
                      .radius_rad = glm::radians(sun->angle_deg),
                      .radiance = sun->radiance};
      environment.unturned_ +=
          sh::discLight(sh::kMaxOrder, disc.direction, static_cast<double>(disc.radius_rad), disc.radiance);
      environment.discs_.push_back(disc);
    } else {
      const auto& file = std::get<spec::ProbeLight>(light);
      Result<spec::Probe> probe = spec::loadProbe(file);
      if (!probe) return failAgain(probe.error());
      if (probe->texels_not_finite > 0)
        environment.notices_.push_back(fmt::format("{}: {} texels are not finite and count as black",
                                                   file.file.string(), probe->texels_not_finite));
      environment.unturned_ +=
          sh::projectImage(sh::kMaxOrder, probe->layout, static_cast<int>(probe->image.width),
                           static_cast<int>(probe->image.height), probe->image.texels);
      environment.probes_.push_back(std::move(*probe));
    }
  }
  environment.light_ = environment.unturned_;
  return environment;
}

glm::mat3 Environment::worldFromLight() const {
  return spec::lightRotation(turn_degrees_);
}

void Environment::setTurn(float degrees) {
  if (degrees == turn_degrees_) return;
  turn_degrees_ = degrees;
  // Always from the unturned light, so that no error gathers over many turns.
  const Result<glm::dmat3> rotation = sh::orthonormalised(glm::dmat3(worldFromLight()));
  light_ = rotation ? sh::Rotation(*rotation, sh::kMaxOrder).apply(unturned_) : unturned_;
  ++version_;
}

}  // namespace lambent::lighting
