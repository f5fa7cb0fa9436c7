#include "runtime/bounces/patch_room.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "runtime/bounces/patch_light.hpp"

namespace lambent::frame {

namespace {

// Returns the relative change, at most 1.
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

lighting::ShadowedLight ofUnitPower(lighting::ShadowedLight lamp) {
  lamp.power = glm::vec3(1.0f);
  return lamp;
}

spec::Disc ofUnitPower(spec::Disc key) {
  key.radiance = glm::vec3(1.0f);
  return key;
}

bool sameLight(const lighting::ShadowedLight& a, const lighting::ShadowedLight& b) {
  return a == b;
}

bool sameLight(const spec::Disc& a, const spec::Disc& b) {
  return a.direction == b.direction && a.radius_rad == b.radius_rad;
}

using Light = std::variant<lighting::ShadowedLight, spec::Disc>;
bool sameSource(const Light& a, const Light& b) {
  if (a.index() != b.index()) return false;
  return a.index() == 0 ? sameLight(std::get<0>(a), std::get<0>(b))
                        : sameLight(std::get<1>(a), std::get<1>(b));
}

}  // namespace

std::vector<PatchRoom::Source> PatchRoom::shineAll(const RoomLights& lights,
                                                   const std::vector<Source>& kept) {
  std::vector<Source> sources;
  for (const lighting::ShadowedLight& lamp : lights.lamps) sources.push_back({ofUnitPower(lamp), {}});
  for (const spec::Disc& key : lights.keys) sources.push_back({ofUnitPower(key), {}});

  std::vector<spec::Disc> new_keys;
  std::vector<Source*> to_trace;
  for (Source& source : sources) {
    const auto found = std::ranges::find_if(
        kept, [&](const Source& other) { return sameSource(source.light, other.light); });
    if (found != kept.end()) {
      source.direct = found->direct;
      continue;
    }
    to_trace.push_back(&source);
    if (const auto* key = std::get_if<spec::Disc>(&source.light)) new_keys.push_back(*key);
  }
  traced_ = static_cast<std::uint32_t>(to_trace.size());

  const std::vector<std::vector<float>> by_key = keysOnPatches(new_keys, transport_->patches(), others_);
  auto next_key = by_key.begin();
  for (Source* source : to_trace) {
    const auto* lamp = std::get_if<lighting::ShadowedLight>(&source->light);
    source->direct = lamp != nullptr ? lampOnPatches(*lamp, transport_->patches(), others_, world_from_group_)
                                     : *next_key++;
  }
  return sources;
}

// Interpolates between light probes with weights by squared distance, which is as smooth as probes are meant
// to be.
std::vector<glm::vec3> PatchRoom::bandsOnPatches(std::vector<glm::vec4> KeyBands::*light) const {
  const lighting::Patches& patches = transport_->patches();
  const float least = 1e-3f * patches.extent();
  std::vector<glm::vec3> direct;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    glm::vec3 sum(0.0f);
    float weights = 0.0f;
    for (const KeyBands& probe : bands_) {
      const float away = std::max(glm::distance(patches.all()[i].points[0], probe.position), least);
      sum += transport_->direct(i, probe.*light) / (away * away);
      weights += 1.0f / (away * away);
    }
    direct.push_back(sum / weights);
  }
  return direct;
}

void PatchRoom::light(const RoomLights& lights, const glm::mat4& world_from_group,
                      std::span<const lighting::RayTriangle> others) {
  traced_ = 0;
  if (!transport_) return;
  std::vector<Source> kept;
  if (world_from_group == world_from_group_ && std::ranges::equal(others, others_))
    kept = std::move(sources_);
  world_from_group_ = world_from_group;
  others_.assign(others.begin(), others.end());

  std::vector<glm::vec3> powers;
  for (const lighting::ShadowedLight& lamp : lights.lamps) powers.push_back(lamp.power);
  for (const spec::Disc& key : lights.keys) powers.push_back(key.radiance);
  sources_ = shineAll(lights, kept);
  const bool same_sources = std::ranges::equal(
      sources_, kept, [](const Source& a, const Source& b) { return sameSource(a.light, b.light); });
  const bool same_bands = lights.bands == bands_;
  const bool same = same_sources && powers == powers_ && same_bands;
  powers_ = std::move(powers);
  if (same) return;
  if (!same_bands) {
    bands_ = lights.bands;
    keys_by_bands_.clear();
    given_off_by_bands_.clear();
    if (!bands_.empty()) {
      keys_by_bands_ = bandsOnPatches(&KeyBands::keys);
      given_off_by_bands_ = transport_->bounce(bandsOnPatches(&KeyBands::all));
    }
  }

  std::vector<glm::vec3> given_off;
  if (!lights.none()) {
    std::vector<glm::vec3> direct(transport_->patches().size(), glm::vec3(0.0f));
    for (std::size_t k = 0; k < sources_.size(); ++k)
      for (std::size_t i = 0; i < direct.size(); ++i) direct[i] += powers_[k] * sources_[k].direct[i];
    if (!keys_by_bands_.empty())
      for (std::size_t i = 0; i < direct.size(); ++i) direct[i] -= keys_by_bands_[i];
    given_off = transport_->bounce(direct);
  }
  drift_ += changeBetween(given_off_, given_off);
  given_off_ = std::move(given_off);
  ++version_;
}

}  // namespace lambent::frame
