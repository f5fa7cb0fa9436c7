#include "runtime/lighting/group_lights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "runtime/base/threads.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::lighting {

namespace {

// Returns the relative change, at most 1.
float changeBetween(std::span<const glm::vec3> before, std::span<const glm::vec3> after) {
  double change = 0.0, power = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const glm::dvec3 a(before[i]), b(after[i]);
    change += glm::dot(a - b, a - b);
    power += std::max(glm::dot(a, a), glm::dot(b, b));
  }
  return power > 0.0 ? static_cast<float>(std::min(std::sqrt(change / power), 1.0)) : 0.0f;
}

// The group's own lights stand in the table three times.
constexpr std::size_t kLampBlocks = 3;

bool partsLamps(const GroupPlace& place) {
  return place.parted && std::ranges::any_of(place.lamps_apart, [](float share) { return share > 0.0f; });
}

// Lamps that are kept apart give light, so their band 0 is not zero.
bool hasLampsApart(const GroupPlace& place) {
  return place.parted && std::ranges::any_of(place.incident, [](const Incident& incident) {
           return incident.key != nullptr && incident.key->c[0] != glm::vec3(0.0f);
         });
}

// Return what arrives at a light probe in world axes: the light without key lights (all light if the place
// is not parted), and the key lights.
sh::LightVector lightOf(const Environment& environment, const GroupPlace& place, std::size_t sample) {
  const Incident& incident = place.incident[sample];
  if (place.parted) return incident.light != nullptr ? *incident.light : environment.restLight();
  return incident.light != nullptr ? *incident.light + *incident.key : environment.light();
}

sh::LightVector keyLightOf(const Environment& environment, const GroupPlace& place, std::size_t sample) {
  if (!place.parted) return sh::LightVector(1);
  const Incident& incident = place.incident[sample];
  return incident.key != nullptr ? *incident.key : environment.keyLight();
}

}  // namespace

void GroupLights::layOut(std::span<const GroupPlace> groups) {
  groups_.follow(groups, &GroupPlace::key);
  std::vector<glm::vec4> coefficients;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const std::size_t samples = groups[i].incident.size(), lamps = groups[i].lamps.size();
    Group& group = groups_[i];
    const auto first = static_cast<std::uint32_t>(coefficients.size());
    coefficients.resize(first + kStride * samples + kLampBlocks * lamps, glm::vec4(0.0f));
    if (group.version != 0 && sameLayout(groups[i], group)) {
      std::copy_n(coefficients_.begin() + group.first, kStride * samples + kLampBlocks * lamps,
                  coefficients.begin() + first);
    } else {
      group = {};
      group.samples.resize(samples);
      group.lamps.resize(lamps);
    }
    group.first = first;
  }
  coefficients_ = std::move(coefficients);
}

bool GroupLights::sameLayout(const GroupPlace& place, const Group& group) {
  return place.lamps.size() == group.lamps.size() && place.incident.size() == group.samples.size();
}

bool GroupLights::updateLamps(Group& group, const GroupPlace& place) {
  const std::vector<float> apart = place.parted ? place.lamps_apart : std::vector<float>();
  if (group.lamps_version != 0 && group.lamps == place.lamps && group.lamps_apart == apart) return false;
  group.change = std::max(group.change, changeBetween(group.lamps, place.lamps));
  group.lamps = place.lamps;
  group.lamps_apart = apart;
  group.lamps_version = ++version_;
  const std::size_t first = group.first + kStride * group.samples.size();
  const std::size_t count = group.lamps.size();
  for (std::size_t k = 0; k < count; ++k) {
    const float share = k < apart.size() ? apart[k] : 0.0f;
    coefficients_[first + k] = glm::vec4(group.lamps[k], 0.0f);
    coefficients_[first + count + k] = glm::vec4((1.0f - share) * group.lamps[k], 0.0f);
    coefficients_[first + 2 * count + k] = glm::vec4(share * group.lamps[k], 0.0f);
  }
  return true;
}

void GroupLights::update(const Environment& environment, sh::Window window,
                         std::span<const GroupPlace> groups, gpu::Counters& counters, int max_order) {
  // Blocks move when groups come or go.
  const bool same_groups = std::ranges::equal(groups, groups_.keys(), {}, &GroupPlace::key) &&
                           std::ranges::equal(groups, groups_, sameLayout);
  if (!same_groups) layOut(groups);
  const bool environment_changed = environment.version() != environment_version_;
  const bool window_changed = window != window_ || max_order != max_order_;
  bool any_changed = !same_groups;
  std::vector<Renewal> renewals;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    Group& group = groups_[i];
    const GroupPlace& place = groups[i];
    const bool turned = group.world_from_group != place.world_from_group;
    const bool cut_anew = window_changed || group.order != place.order || group.parted != place.parted;
    group.world_from_group = place.world_from_group;
    group.order = place.order;
    group.parted = place.parted;
    group.change = 0.0f;
    bool changed = updateLamps(group, place);
    for (std::size_t k = 0; k < place.incident.size(); ++k) {
      const Incident& incident = place.incident[k];
      Sample& sample = group.samples[k];
      const bool from_environment = incident.light == nullptr;
      const bool same_light = sample.version != 0 && sample.from_environment == from_environment &&
                              (from_environment ? !environment_changed : sample.seen == incident.version);
      if (same_light && !turned && !cut_anew) continue;
      sample.from_environment = from_environment;
      sample.seen = incident.version;
      sample.version = ++version_;
      changed = true;
      renewals.push_back({i, k, !same_light || cut_anew});
    }
    if (changed) group.version = version_;
    any_changed |= changed;
  }
  renewed_ = static_cast<std::uint32_t>(renewals.size());
  environment_version_ = environment.version();
  has_keys_ = !environment.keys().empty() || std::ranges::any_of(groups, hasLampsApart);
  has_parted_lamps_ = std::ranges::any_of(groups, partsLamps);
  window_ = window;
  max_order_ = max_order;
  followWindows(environment, window, groups, renewals);
  write(environment, groups, renewals);
  if (!any_changed || coefficients_.empty()) return;
  table_.assign(std::span<const glm::vec4>(coefficients_));
  counters.uploaded_bytes += coefficients_.size() * sizeof(glm::vec4);
}

void GroupLights::followWindows(const Environment& environment, sh::Window window,
                                std::span<const GroupPlace> groups, std::span<const Renewal> renewals) {
  // Each search takes 30 to 75 microseconds.
  constexpr std::size_t kWorthAThread = 8;
  struct Search {
    sh::CachedWindow* kept;
    sh::LightVector light;
  };
  std::vector<Search> searches;
  std::array<bool, 2 * (sh::kMaxOrder + 1)> followed{};
  for (const Renewal& renewal : renewals) {
    if (!renewal.light) continue;
    const GroupPlace& place = groups[renewal.group];
    const bool from_environment = place.incident[renewal.sample].light == nullptr;
    if (from_environment && std::exchange(followed[environmentWindow(place)], true)) continue;
    sh::CachedWindow& kept = windowOf(renewal, place);
    const int bands = std::min(static_cast<int>(place.order), max_order_);
    const sh::LightVector light = lightOf(environment, place, renewal.sample).truncated(bands);
    if (!kept.fits(light, window)) searches.push_back({&kept, light});
  }
  inParallel(searches.size(), kWorthAThread,
             [&](std::size_t i) { searches[i].kept->follow(searches[i].light, window); });
}

sh::CachedWindow& GroupLights::windowOf(const Renewal& renewal, const GroupPlace& place) {
  if (place.incident[renewal.sample].light != nullptr)
    return groups_[renewal.group].samples[renewal.sample].window;
  return environment_windows_[environmentWindow(place)];
}

void GroupLights::write(const Environment& environment, std::span<const GroupPlace> groups,
                        std::span<const Renewal> renewals) {
  std::optional<sh::Rotation> rotation;
  std::size_t rotation_of = 0;  // index of the group that the rotation is for
  for (const Renewal& renewal : renewals) {
    const GroupPlace& place = groups[renewal.group];
    Group& group = groups_[renewal.group];
    Sample& sample = group.samples[renewal.sample];
    const int order = static_cast<int>(place.order), bands = std::min(order, max_order_);
    if (renewal.light) {
      const sh::BandWeights& weights = windowOf(renewal, place).weights();
      const sh::LightVector light_ws =
          sh::applyWeights(lightOf(environment, place, renewal.sample).truncated(bands), weights)
              .truncated(order);
      const sh::LightVector key_ws =
          keyLightOf(environment, place, renewal.sample).truncated(bands).truncated(order);
      group.change =
          std::max(group.change, changeBetween((sample.light_ws + sample.key_ws).c, (light_ws + key_ws).c));
      sample.light_ws = light_ws;
      sample.key_ws = key_ws;
    }
    if (!rotation || rotation_of != renewal.group) {
      rotation_of = renewal.group;
      rotation.emplace(glm::conjugate(glm::dquat(place.world_from_group)), order);
    }
    const auto put = [&](const sh::LightVector& light_ws, std::size_t first) {
      const sh::LightVector light_group = rotation->apply(light_ws);
      for (std::size_t c = 0; c < kBlock; ++c) coefficients_[first + c] = glm::vec4(light_group.c[c], 0.0f);
    };
    const std::size_t first = group.first + kStride * renewal.sample;
    put(sample.light_ws, first);
    put(sample.key_ws, first + kBlock);
  }
}

}  // namespace lambent::lighting
