#include "runtime/frame/lamp_room.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "runtime/frame/lamp_light.hpp"

namespace lambent::frame {

namespace {

// By how much of itself something changed, at most 1.
double changeBetween(const std::vector<glm::vec3>& before, const std::vector<glm::vec3>& after) {
  if (before.size() != after.size()) return 1.0;
  double change = 0.0, power = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const glm::dvec3 a(before[i]), b(after[i]);
    change += glm::dot(a - b, a - b);
    power += std::max(glm::dot(a, a), glm::dot(b, b));
  }
  return power > 0.0 ? std::min(std::sqrt(change / power), 1.0) : 0.0;
}

}  // namespace

void LampRoom::light(std::span<const lighting::NearLight> lamps, const glm::mat4& world_from_group,
                     std::span<const lighting::RayTriangle> others) {
  bounced_ = 0;
  if (!transport_) return;
  std::vector<Lamp> kept;
  if (world_from_group == world_from_group_ && std::ranges::equal(others, others_)) kept = std::move(lamps_);
  world_from_group_ = world_from_group;
  others_.assign(others.begin(), others.end());

  std::vector<Lamp> now;
  std::vector<glm::vec3> powers;
  bool same = lamps.size() == powers_.size() && kept.size() == lamps.size();
  for (std::size_t k = 0; k < lamps.size(); ++k) {
    lighting::NearLight unit = lamps[k];
    unit.power = glm::vec3(1.0f);
    powers.push_back(lamps[k].power);
    const auto found = std::ranges::find(kept, unit, &Lamp::light);
    if (found != kept.end()) {
      same &= found == kept.begin() + static_cast<std::ptrdiff_t>(k) && powers[k] == powers_[k];
      now.push_back(*found);
      continue;
    }
    same = false;
    ++bounced_;
    const std::vector<float> direct = lampOnPatches(unit, transport_->patches(), others, world_from_group);
    now.push_back({.light = unit, .given_off = transport_->bounce(direct)});
  }
  lamps_ = std::move(now);
  powers_ = std::move(powers);
  if (same) return;

  std::vector<glm::vec3> sum;
  if (!lamps_.empty()) sum.assign(transport_->patches().size(), glm::vec3(0.0f));
  for (std::size_t k = 0; k < lamps_.size(); ++k)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += powers_[k] * lamps_[k].given_off[i];
  drift_ += changeBetween(given_off_, sum);
  given_off_ = std::move(sum);
  ++version_;
}

}  // namespace lambent::frame
