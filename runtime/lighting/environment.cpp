#include "runtime/lighting/environment.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/spec/rotate.hpp"

namespace lambent::lighting {

Result<Environment> Environment::create(const std::vector<spec::Light>& lights,
                                        const std::vector<spec::Light>& second_lights) {
  Environment environment;
  const std::array<const std::vector<spec::Light>*, kSets> given = {&lights, &second_lights};
  for (std::size_t i = 0; i < kSets; ++i) {
    Result<spec::DistantLights> loaded = spec::loadDistantLights(*given[i]);
    if (!loaded) return failAgain(loaded.error());
    Set& set = environment.sets_[i];
    set.lights = std::move(*loaded);
    set.sky = set.lights.skyVector();
    set.discs = set.lights.discVector();
    environment.notices_.insert(environment.notices_.end(), set.lights.notices.begin(),
                                set.lights.notices.end());
  }
  environment.mix();
  return environment;
}

glm::mat3 Environment::worldFromLight() const {
  return spec::lightRotation(turn_degrees_);
}

float Environment::shareOf(std::size_t index) const {
  return intensity_ * (index == 0 ? 1.0f - fade_ : fade_);
}

// Always from the light as loaded: no error gathers over turns and fades.
void Environment::mix() {
  const glm::mat3 world_from_light = worldFromLight();
  sh::LightVector sky{.order = sh::kMaxOrder}, discs{.order = sh::kMaxOrder};
  discs_.clear();
  for (std::size_t i = 0; i < kSets; ++i) {
    const float share = shareOf(i);
    sky += share * sets_[i].sky;
    discs += share * sets_[i].discs;
    for (const Disc& disc : sets_[i].lights.discs)
      discs_.push_back({.direction = world_from_light * disc.direction,
                        .radius_rad = disc.radius_rad,
                        .radiance = share * disc.radiance});
  }
  sky_light_ = spec::turned(sky, turn_degrees_);
  light_ = spec::turned(sky + discs, turn_degrees_);
  ++version_;
}

void Environment::setTurn(float degrees) {
  if (degrees == turn_degrees_ || !std::isfinite(degrees)) return;
  turn_degrees_ = degrees;
  mix();
}

void Environment::setFade(float fade) {
  if (!std::isfinite(fade)) return;
  fade = std::clamp(fade, 0.0f, 1.0f);
  if (fade == fade_) return;
  fade_ = fade;
  mix();
}

void Environment::setIntensity(float intensity) {
  if (!std::isfinite(intensity)) return;
  intensity = std::max(intensity, 0.0f);
  if (intensity == intensity_) return;
  intensity_ = intensity;
  mix();
}

}  // namespace lambent::lighting
