#include "runtime/lighting/environment.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <system_error>
#include <utility>

#include <glm/geometric.hpp>

#include "runtime/bundle/container.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::lighting {

namespace {

// An edit applies to a key light up to this far away, or within its disc, because other settings divide the
// same picture a little differently.
constexpr float kSameKey_rad = 0.01f;
constexpr float kLargest = std::numeric_limits<float>::max();

// Combines values into a checksum. Checksums and sizes enter as they are; data held by reference enters by
// its own checksum.
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
  void add(const Disc& disc) {
    add(disc.direction);
    add(disc.radius_rad);
    add(disc.radiance);
  }
  std::uint64_t value() const { return std::max<std::uint64_t>(bundle::checksum(bytes_), 1); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace

Environment::EnvironmentMapSource Environment::sourceOf(const spec::EnvironmentMapLight& light) {
  std::error_code code;  // a missing file is reported by whoever reads it
  EnvironmentMapSource source{light.file, light.layout, std::filesystem::last_write_time(light.file, code),
                              0};
  source.bytes = std::filesystem::file_size(light.file, code);
  return source;
}

Result<Environment> Environment::create(const std::vector<spec::Light>& lights,
                                        const std::vector<spec::Light>& second_lights) {
  Environment environment;
  if (auto done = environment.setLights(lights, second_lights); !done) return failAgain(done.error());
  return environment;
}

Result<void> Environment::setLights(const std::vector<spec::Light>& lights,
                                    const std::vector<spec::Light>& second_lights) {
  const std::array<const std::vector<spec::Light>*, kSets> given = {&lights, &second_lights};
  std::array<Set, kSets> sets;
  for (std::size_t i = 0; i < kSets; ++i) {
    Set& set = sets[i];
    const auto load = [&](const spec::EnvironmentMapLight& light) -> Result<spec::EnvironmentMap> {
      EnvironmentMapSource source = sourceOf(light);
      for (const Set& before : sets_)
        for (std::size_t k = 0; k < before.known.size(); ++k)
          if (before.known[k].source == source) {
            set.known.push_back(before.known[k]);
            return before.lights.environment_maps[k];
          }
      Result<spec::EnvironmentMap> loaded = spec::loadEnvironmentMap(light);
      if (!loaded) return loaded;
      const spec::RgbImage& image = loaded->image;
      set.known.push_back({std::move(source),
                           sh::projectImage(sh::kMaxOrder, loaded->layout, static_cast<int>(image.width),
                                            static_cast<int>(image.height), image.texels),
                           bundle::checksum(std::as_bytes(std::span(image.texels)))});
      return loaded;
    };
    Result<spec::DistantLights> made = spec::loadDistantLights(*given[i], load);
    if (!made) return failAgain(made.error());
    set.lights = std::move(*made);
    part(set);
  }
  sets_ = std::move(sets);
  for (std::size_t i = 0; i < kSets; ++i) applyEdits(i);
  notices_.clear();
  for (const Set& set : sets_)
    notices_.insert(notices_.end(), set.lights.notices.begin(), set.lights.notices.end());
  seal();
  mix();
  return {};
}

void Environment::part(Set& set) const {
  set.parted = partLights(set.lights, {.most = most_keys_});
  set.sky = sh::constantLight(sh::kMaxOrder, set.lights.constant);
  for (std::size_t k = 0; k < set.known.size(); ++k) {
    const std::optional<spec::EnvironmentMap>& rest = set.parted.environment_maps[k];
    set.sky += rest ? sh::projectImage(sh::kMaxOrder, rest->layout, static_cast<int>(rest->image.width),
                                       static_cast<int>(rest->image.height), rest->image.texels)
                    : set.known[k].sky;
  }
  set.discs = spec::discVector(set.parted.discs);
  set.edits.clear();
  set.pictures.clear();
}

void Environment::applyEdits(std::size_t index) {
  Set& set = sets_[index];
  const std::size_t count = set.parted.keys.size();
  std::vector<std::optional<spec::KeyEdit>> edits(count);
  for (const spec::KeyEdit& edit : key_edits_) {
    if (edit.set != index) continue;
    std::optional<std::size_t> nearest;
    float least_rad = 0.0f;
    for (std::size_t k = 0; k < count; ++k) {
      if (!set.parted.origins[k].in_map) continue;
      const Disc& key = set.parted.keys[k];
      const float angle_rad = std::acos(std::clamp(glm::dot(key.direction, edit.found), -1.0f, 1.0f));
      if (angle_rad > std::max(kSameKey_rad, key.radius_rad) || (nearest && angle_rad >= least_rad)) continue;
      nearest = k;
      least_rad = angle_rad;
    }
    if (nearest) edits[*nearest] = edit;
  }
  set.key_discs = set.parted.keys;
  bool same_pictures = set.edits.size() == count && set.pictures.size() == set.lights.environment_maps.size();
  for (std::size_t k = 0; k < count; ++k) {
    same_pictures = same_pictures && set.edits[k].has_value() == edits[k].has_value();
    if (!edits[k]) continue;
    set.key_discs[k].direction = edits[k]->towards;
    set.key_discs[k].radiance *= edits[k]->factor;
  }
  set.edits = std::move(edits);
  set.keys = spec::discVector(set.key_discs);
  if (same_pictures) return;
  set.pictures.assign(set.lights.environment_maps.size(), std::nullopt);
  for (const KeyTexel& texel : set.parted.texels) {
    if (!set.edits[texel.key]) continue;
    std::optional<spec::EnvironmentMap>& picture = set.pictures[texel.environment_map];
    if (!picture) picture = set.lights.environment_maps[texel.environment_map];
    picture->image.texels[texel.texel] =
        set.parted.environment_maps[texel.environment_map]->image.texels[texel.texel];
  }
}

void Environment::setKeyEdits(std::vector<spec::KeyEdit> edits) {
  if (edits == key_edits_) return;
  key_edits_ = std::move(edits);
  for (std::size_t i = 0; i < kSets; ++i) applyEdits(i);
  seal();
  mix();
}

void Environment::setMostKeys(std::uint32_t most) {
  if (most == most_keys_) return;
  most_keys_ = most;
  for (std::size_t i = 0; i < kSets; ++i) {
    part(sets_[i]);
    applyEdits(i);
  }
  seal();
  mix();
}

void Environment::setSuns(std::vector<Disc> suns) {
  if (suns == suns_) return;
  suns_ = std::move(suns);
  mix();
}

Environment::Part Environment::restOf(std::size_t index) const {
  const Set& set = sets_[index];
  Part rest{.environment_maps = {}, .constant = set.lights.constant, .discs = set.parted.discs};
  for (std::size_t k = 0; k < set.lights.environment_maps.size(); ++k) {
    const std::optional<spec::EnvironmentMap>& parted = set.parted.environment_maps[k];
    rest.environment_maps.push_back(parted ? &*parted : &set.lights.environment_maps[k]);
  }
  return rest;
}

Environment::Part Environment::shownOf(std::size_t index) const {
  const Set& set = sets_[index];
  Part shown{.environment_maps = {}, .constant = set.lights.constant, .discs = set.lights.discs};
  for (std::size_t k = 0; k < set.lights.environment_maps.size(); ++k)
    shown.environment_maps.push_back(set.pictures[k] ? &*set.pictures[k] : &set.lights.environment_maps[k]);
  for (std::size_t k = 0; k < set.key_discs.size(); ++k)
    if (set.edits[k]) shown.discs.push_back(set.key_discs[k]);
  return shown;
}

std::vector<Environment::FoundKey> Environment::foundKeys() const {
  std::vector<FoundKey> found;
  for (std::size_t i = 0; i < kSets; ++i) {
    const Set& set = sets_[i];
    for (std::size_t k = 0; k < set.key_discs.size(); ++k)
      found.push_back({.set = i,
                       .origin = set.parted.origins[k],
                       .found = set.parted.keys[k],
                       .now = set.key_discs[k],
                       .edit = set.edits[k]});
  }
  return found;
}

void Environment::seal() {
  Seal seal;
  seal.add(most_keys_);
  for (const Set& set : sets_) {
    seal.add(set.lights.constant);
    seal.add(set.lights.discs.size());
    for (const Disc& disc : set.lights.discs) seal.add(disc);
    seal.add(set.lights.environment_maps.size());
    for (std::size_t k = 0; k < set.lights.environment_maps.size(); ++k) {
      const spec::EnvironmentMap& environment_map = set.lights.environment_maps[k];
      seal.add(static_cast<std::uint32_t>(environment_map.layout));
      seal.add(environment_map.image.width);
      seal.add(environment_map.image.height);
      seal.add(set.known[k].checksum);
    }
  }
  rest_version_ = lights_version_ = pictures_version_ = seal.value();
  Seal edits, edited;
  edits.add(rest_version_);
  edited.add(rest_version_);
  bool any = false;
  for (std::size_t i = 0; i < kSets; ++i)
    for (std::size_t k = 0; k < sets_[i].edits.size(); ++k) {
      const std::optional<spec::KeyEdit>& edit = sets_[i].edits[k];
      if (!edit) continue;
      any = true;
      for (Seal* of : {&edits, &edited}) {
        of->add(i);
        of->add(k);
      }
      edits.add(edit->towards);
      edits.add(edit->factor);
    }
  if (!any) return;
  lights_version_ = edits.value();
  pictures_version_ = edited.value();
}

glm::mat3 Environment::worldFromLight() const {
  return spec::lightRotation(turn_degrees_);
}

float Environment::shareOf(std::size_t index) const {
  return intensity_ * (index == 0 ? 1.0f - fade_ : fade_);
}

// Mixes from the lights as loaded, so that no error accumulates over turns and fades.
void Environment::mix() {
  const glm::mat3 world_from_light = worldFromLight();
  sh::LightVector sky{.order = sh::kMaxOrder}, discs{.order = sh::kMaxOrder}, keys{.order = sh::kMaxOrder};
  discs_.clear();
  const auto place = [&](const std::vector<Disc>& unturned, float share) {
    for (const Disc& disc : unturned)
      discs_.push_back({.direction = world_from_light * disc.direction,
                        .radius_rad = disc.radius_rad,
                        .radiance = share * disc.radiance});
  };
  for (std::size_t i = 0; i < kSets; ++i) {
    const float share = shareOf(i);
    sky += share * sets_[i].sky;
    discs += share * sets_[i].discs;
    keys += share * sets_[i].keys;
    place(sets_[i].parted.discs, share);
  }
  first_key_ = discs_.size();
  for (std::size_t i = 0; i < kSets; ++i) place(sets_[i].key_discs, shareOf(i));
  discs_.insert(discs_.end(), suns_.begin(), suns_.end());
  sky_light_ = spec::turned(sky, turn_degrees_);
  key_light_ = spec::turned(keys, turn_degrees_) + spec::discVector(suns_);
  rest_light_ = spec::turned(sky + discs, turn_degrees_);
  light_ = rest_light_ + key_light_;
  Seal seal;
  seal.add(lights_version_);
  for (const float value : {turn_degrees_, fade_, intensity_}) seal.add(value);
  for (const Disc& sun : suns_) seal.add(sun);
  version_ = seal.value();
}

void Environment::change(float& kept, float value, float least, float greatest) {
  if (!std::isfinite(value)) return;
  value = std::clamp(value, least, greatest);
  if (value == kept) return;
  kept = value;
  mix();
}

void Environment::setTurn(float degrees) {
  change(turn_degrees_, degrees, -kLargest, kLargest);
}

void Environment::setFade(float fade) {
  change(fade_, fade, 0.0f, 1.0f);
}

void Environment::follow(const scene::EnvironmentComponent& component) {
  setTurn(component.rotation_deg);
  setFade(component.fade);
  setIntensity(component.intensity);
}

void Environment::setIntensity(float intensity) {
  change(intensity_, intensity, 0.0f, kLargest);
}

}  // namespace lambent::lighting
