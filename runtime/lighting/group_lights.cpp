#include "runtime/lighting/group_lights.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "runtime/sh/rotation.hpp"

namespace lambent::lighting {

void GroupLights::update(const Environment& environment, sh::Window window,
                         std::span<const GroupPlace> groups, gpu::Counters& counters) {
  const bool light_changed = environment.version() != environment_version_ || window != window_;
  bool any_changed = !std::ranges::equal(groups, groups_, [](const GroupPlace& a, const Group& b) {
    return a.lamps.size() == b.place.lamps.size();
  });
  if (any_changed) {
    // Blocks move when groups come, and with them their lamps: all are written again.
    groups_.assign(groups.size(), {});
    std::uint32_t first = 0;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      groups_[i].first = first;
      first += kStride + static_cast<std::uint32_t>(groups[i].lamps.size());
      groups_[i].place.lamps.resize(groups[i].lamps.size());
    }
    coefficients_.assign(first, glm::vec4(0.0f));
  }
  std::array<std::optional<sh::LightVector>, sh::kMaxOrder + 1> windowed;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    Group& group = groups_[i];
    if (!light_changed && group.version != 0 && group.place == groups[i]) continue;
    any_changed = true;
    group.place = groups[i];
    group.version = ++version_;
    const auto order = static_cast<int>(group.place.order);
    auto& light = windowed[group.place.order];
    if (!light) light = sh::applyWindow(environment.light().truncated(order), window);
    const glm::dquat group_from_world = glm::conjugate(glm::dquat(group.place.world_from_group));
    const sh::LightVector light_group = sh::Rotation(group_from_world, order).apply(*light);
    for (std::uint32_t k = 0; k < kStride; ++k)
      coefficients_[group.first + k] = glm::vec4(light_group.c[k], 0.0f);
    for (std::uint32_t k = 0; k < group.place.lamps.size(); ++k)
      coefficients_[group.first + kStride + k] = glm::vec4(group.place.lamps[k], 0.0f);
  }
  environment_version_ = environment.version();
  window_ = window;
  if (!any_changed || coefficients_.empty()) return;
  table_.assign(std::span<const glm::vec4>(coefficients_));
  counters.uploaded_bytes += coefficients_.size() * sizeof(glm::vec4);
}

}  // namespace lambent::lighting
