#include "runtime/lighting/environment.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "runtime/bundle/checksum.hpp"
#include "runtime/spec/rotate.hpp"

namespace lambent::lighting {

namespace {

// Checksums and sizes go in as they are; what is given by reference by its own checksum.
class Seal {
 public:
  template <typename T>
  void add(const T& value) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    const auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void add(const glm::vec3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  std::uint64_t value() const { return std::max<std::uint64_t>(bundle::checksum(bytes_), 1); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace

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
  environment.seal();
  environment.mix();
  return environment;
}

void Environment::seal() {
  Seal seal;
  for (const Set& set : sets_) {
    seal.add(set.lights.constant);
    seal.add(set.lights.discs.size());
    for (const Disc& disc : set.lights.discs) {
      seal.add(disc.direction);
      seal.add(disc.radius_rad);
      seal.add(disc.radiance);
    }
    seal.add(set.lights.probes.size());
    for (const spec::Probe& probe : set.lights.probes) {
      seal.add(static_cast<std::uint32_t>(probe.layout));
      seal.add(probe.image.width);
      seal.add(probe.image.height);
      seal.add(bundle::checksum(std::as_bytes(std::span(probe.image.texels))));
    }
  }
  lights_version_ = seal.value();
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
  Seal seal;
  seal.add(lights_version_);
  for (const float value : {turn_degrees_, fade_, intensity_}) seal.add(value);
  version_ = seal.value();
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
