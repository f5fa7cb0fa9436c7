#include "runtime/lighting/group_lights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>

#include "runtime/sh/rotation.hpp"

namespace lambent::lighting {

namespace {

// By how much of itself something changed, at most 1.
float changeBetween(std::span<const glm::vec3> before, std::span<const glm::vec3> after) {
  double change = 0.0, power = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const glm::dvec3 a(before[i]), b(after[i]);
    change += glm::dot(a - b, a - b);
    power += std::max(glm::dot(a, a), glm::dot(b, b));
  }
  return power > 0.0 ? static_cast<float>(std::min(std::sqrt(change / power), 1.0)) : 0.0f;
}

}  // namespace

void GroupLights::layOut(std::span<const GroupPlace> groups) {
  groups_.assign(groups.size(), {});
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    groups_[i].first = first;
    groups_[i].samples.resize(groups[i].incident.size());
    groups_[i].lamps.resize(groups[i].lamps.size());
    first += kStride * static_cast<std::uint32_t>(groups[i].incident.size()) +
             static_cast<std::uint32_t>(groups[i].lamps.size());
  }
  coefficients_.assign(first, glm::vec4(0.0f));
}

bool GroupLights::updateLamps(Group& group, const GroupPlace& place) {
  if (group.lamps_version != 0 && group.lamps == place.lamps) return false;
  group.change = std::max(group.change, changeBetween(group.lamps, place.lamps));
  group.lamps = place.lamps;
  group.lamps_version = ++version_;
  const std::size_t first = group.first + kStride * group.samples.size();
  for (std::size_t k = 0; k < group.lamps.size(); ++k)
    coefficients_[first + k] = glm::vec4(group.lamps[k], 0.0f);
  return true;
}

void GroupLights::update(const Environment& environment, sh::Window window,
                         std::span<const GroupPlace> groups, gpu::Counters& counters) {
  // Blocks move when groups come, and with them their lamps: all are written again.
  if (!std::ranges::equal(groups, groups_, [](const GroupPlace& a, const Group& b) {
        return a.lamps.size() == b.lamps.size() && a.incident.size() == b.samples.size();
      }))
    layOut(groups);
  const bool environment_changed = environment.version() != environment_version_;
  const bool window_changed = window != window_;
  bool any_changed = false;
  renewed_ = 0;
  std::array<std::optional<sh::LightVector>, sh::kMaxOrder + 1> windowed_environment;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    Group& group = groups_[i];
    const GroupPlace& place = groups[i];
    const bool turned = group.world_from_group != place.world_from_group;
    const bool cut_anew = window_changed || group.order != place.order;
    group.world_from_group = place.world_from_group;
    group.order = place.order;
    const auto order = static_cast<int>(place.order);
    std::optional<sh::Rotation> rotation;
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
      ++renewed_;
      if (!rotation) {
        const glm::dquat group_from_world = glm::conjugate(glm::dquat(place.world_from_group));
        rotation.emplace(group_from_world, order);
      }
      if (!same_light || cut_anew) {
        auto& shared = windowed_environment[place.order];
        if (from_environment && !shared)
          shared = sh::applyWindow(environment.light().truncated(order), window);
        const sh::LightVector light_ws =
            from_environment ? *shared : sh::applyWindow(incident.light->truncated(order), window);
        group.change = std::max(group.change, changeBetween(sample.light_ws.c, light_ws.c));
        sample.light_ws = light_ws;
      }
      const sh::LightVector light_group = rotation->apply(sample.light_ws);
      const std::size_t first = group.first + kStride * k;
      for (std::size_t c = 0; c < kStride; ++c) coefficients_[first + c] = glm::vec4(light_group.c[c], 0.0f);
    }
    if (changed) group.version = version_;
    any_changed |= changed;
  }
  environment_version_ = environment.version();
  window_ = window;
  if (!any_changed || coefficients_.empty()) return;
  table_.assign(std::span<const glm::vec4>(coefficients_));
  counters.uploaded_bytes += coefficients_.size() * sizeof(glm::vec4);
}

}  // namespace lambent::lighting
