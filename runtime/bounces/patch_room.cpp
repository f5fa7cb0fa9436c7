#include "runtime/bounces/patch_room.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "runtime/base/threads.hpp"
#include "runtime/shadows/shadowed_light.hpp"

namespace lambent::frame {

namespace {

using lighting::LocalLight;
using lighting::Patch;

constexpr std::size_t kLampPoints = 16;  // points on a lamp with an extent
constexpr float kLightSurface = 1.01f;   // as in local_shadows.cpp
constexpr float kAlmost = 1.0f - 1e-4f;  // share of the distance to a patch, so that it does not block itself
constexpr std::size_t kPoints = lighting::kPatchPoints;
// Discs at infinity are widened to this radius, so that bounced light does not flicker while they turn. It is
// less than the angle under which patches see their neighbours.
constexpr float kLeastRadius_rad = 0.02f;
constexpr float kAtInfinity = 1e4f;  // in multiples of the patches' extent

// Returns points all over a disc of radius 1, each with a distance from its plane that makes them fill a ball
// (golden angle).
std::vector<glm::vec3> ballPoints() {
  std::vector<glm::vec3> points;
  for (std::size_t i = 0; i < kLampPoints; ++i) {
    const float height = 1.0f - (2.0f * static_cast<float>(i) + 1.0f) / static_cast<float>(kLampPoints);
    const float ring = std::sqrt(1.0f - height * height);
    const float turn = 2.0f * std::numbers::pi_v<float> * std::numbers::phi_v<float> * static_cast<float>(i);
    // Points alternate between the sphere and halfway in, so that they look about even from any side.
    const float radius = i % 2 == 0 ? 0.9f : 0.5f;
    points.push_back(radius * glm::vec3(ring * std::cos(turn), ring * std::sin(turn), height));
  }
  return points;
}

std::vector<glm::vec3> lampPoints(const LocalLight& light) {
  if (!hasExtent(light)) return {light.position_ws};
  std::vector<glm::vec3> points;
  if (light.kind == LocalLight::Kind::Sphere) {
    for (const glm::vec3& point : ballPoints()) points.push_back(light.position_ws + light.radius_m * point);
    return points;
  }
  glm::vec3 s, t;
  glsl::UnshadowedLight().localBasis(light.direction_ws, s, t);
  for (std::size_t i = 0; i < kLampPoints; ++i) {
    const float radius = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(kLampPoints));
    const float turn = 2.0f * std::numbers::pi_v<float> * std::numbers::phi_v<float> * static_cast<float>(i);
    points.push_back(light.position_ws + light.radius_m * radius * (std::cos(turn) * s + std::sin(turn) * t));
  }
  return points;
}

// Returns unit directions to points all over a disc at infinity.
std::vector<glm::vec3> raysTo(const spec::Disc& key) {
  const float radius = std::max(key.radius_rad, kLeastRadius_rad);
  const std::size_t count = radius < 0.05f ? 4 : kLampPoints;
  glm::vec3 s, t;
  glsl::UnshadowedLight().localBasis(key.direction, s, t);
  std::vector<glm::vec3> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const float away =
        std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count)) * std::sin(radius);
    const float turn = 2.0f * std::numbers::pi_v<float> * std::numbers::phi_v<float> * static_cast<float>(i);
    rays.push_back(
        glsl::UnshadowedLight().localUnit(key.direction + away * (std::cos(turn) * s + std::sin(turn) * t)));
  }
  return rays;
}

// Returns what may block the lamp's light. Triangles within a spherical lamp that are no larger than it
// belong to the lamp itself.
lighting::TriangleTree blockersOf(const LocalLight& light, const lighting::Patches& patches,
                                  std::span<const lighting::RayTriangle> others,
                                  const glm::mat4& world_from_group) {
  const auto isLamp = [&](const lighting::RayTriangle& triangle) {
    return light.kind == LocalLight::Kind::Sphere &&
           std::ranges::all_of(triangle.corners, [&](const glm::vec3& corner) {
             const glm::vec3 corner_ws(world_from_group * glm::vec4(corner, 1.0f));
             return glm::distance(corner_ws, light.position_ws) <= kLightSurface * light.radius_m;
           });
  };
  std::vector<lighting::RayTriangle> blockers;
  for (const lighting::RayTriangle& own : patches.tree().triangles())
    if (!isLamp(own)) blockers.push_back(own);
  for (const lighting::RayTriangle& other : others)
    if (!isLamp(other)) blockers.push_back(other);
  return {std::move(blockers), patches.tree().leastDistance()};
}

}  // namespace

std::vector<float> lampOnPatches(const LocalLight& lamp, const lighting::Patches& patches,
                                 std::span<const lighting::RayTriangle> others,
                                 const glm::mat4& world_from_group) {
  LocalLight light = lamp;
  if (const float length = glm::length(light.direction_ws); length > 0.0f) light.direction_ws /= length;
  const ShadowedLightRecord record = recordOf(light, 0.0f);
  const std::vector<Patch>& all = patches.all();
  const glm::mat4 group_from_world = glm::inverse(world_from_group);
  const glm::mat3 world_from_normal = glm::transpose(glm::mat3(group_from_world));

  std::vector<glm::vec3> points_ws;  // slightly above their patches
  std::vector<float> shares;         // without blockers
  for (const Patch& patch : all) {
    const glm::vec3 normal_ws = glsl::UnshadowedLight().localUnit(world_from_normal * patch.normal);
    for (const glm::vec3& point : patch.points) {
      points_ws.emplace_back(world_from_group * glm::vec4(point, 1.0f));
      shares.push_back(
          glsl::UnshadowedLight().localShare(record, normal_ws, light.position_ws - points_ws.back()));
    }
  }

  // Each point of the lamp is connected with all points of patches that it shines on.
  const std::vector<glm::vec3> lamp_points = lampPoints(light);
  const lighting::TriangleTree blockers = blockersOf(light, patches, others, world_from_group);
  std::vector<std::vector<std::uint8_t>> seen(lamp_points.size());
  inParallel(lamp_points.size(), 1, [&](std::size_t l) {
    const glm::vec3 from(group_from_world * glm::vec4(lamp_points[l], 1.0f));
    seen[l].assign(shares.size(), 0);
    for (std::size_t i = 0; i < shares.size(); ++i) {
      if (shares[i] <= 0.0f) continue;
      const glm::vec3 way = all[i / kPoints].points[i % kPoints] - from;
      seen[l][i] = blockers.blocked(from, way, kAlmost) ? 0 : 1;
    }
  });

  std::vector<float> direct(all.size(), 0.0f);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    std::uint32_t count = 0;
    for (const std::vector<std::uint8_t>& from_point : seen) count += from_point[i];
    direct[i / kPoints] +=
        shares[i] * static_cast<float>(count) / static_cast<float>(lamp_points.size() * kPoints);
  }
  return direct;
}

std::vector<std::vector<float>> keysOnPatches(std::span<const spec::Disc> keys,
                                              const lighting::Patches& patches,
                                              std::span<const lighting::RayTriangle> others) {
  if (keys.empty()) return {};  // as in every frame in which no light moved
  std::vector<lighting::RayTriangle> triangles = patches.tree().triangles();
  triangles.insert(triangles.end(), others.begin(), others.end());
  const lighting::TriangleTree blockers(std::move(triangles), patches.tree().leastDistance());
  std::vector<std::vector<glm::vec3>> rays_to;
  for (const spec::Disc& key : keys) rays_to.push_back(raysTo(key));

  std::vector<std::vector<float>> direct(keys.size(), std::vector<float>(patches.size(), 0.0f));
  constexpr std::size_t kBlock = 32;  // patches per unit of work
  inParallel((patches.size() + kBlock - 1) / kBlock, 1, [&](std::size_t block) {
    for (std::size_t i = block * kBlock; i < std::min(patches.size(), (block + 1) * kBlock); ++i) {
      const Patch& patch = patches.all()[i];
      for (std::size_t p = 0; p < kPoints; ++p) {
        for (std::size_t k = 0; k < keys.size(); ++k) {
          const float share = glsl::UnshadowedLight().sphereShare(glm::dot(patch.normal, keys[k].direction),
                                                                  1.0f / std::sin(keys[k].radius_rad));
          if (share <= 0.0f) continue;
          float seen = 0.0f, all = 0.0f;
          // The points of a patch share the rays.
          for (std::size_t r = p; r < rays_to[k].size(); r += kPoints) {
            const glm::vec3& ray = rays_to[k][r];
            const float cosine = std::max(glm::dot(ray, patch.normal), 0.0f);
            all += cosine;
            if (cosine > 0.0f && !blockers.blocked(patch.origins[p], ray, kAtInfinity * patches.extent()))
              seen += cosine;
          }
          if (all > 0.0f) direct[k][i] += share * seen / (all * static_cast<float>(kPoints));
        }
      }
    }
  });
  return direct;
}

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

}  // namespace

std::vector<PatchRoom::Source> PatchRoom::shineAll(const RoomLights& lights,
                                                   const std::vector<Source>& kept) {
  std::vector<Source> sources;
  for (lighting::LocalLight lamp : lights.lamps) {
    lamp.power = glm::vec3(1.0f);
    sources.push_back({lamp, {}});
  }
  for (spec::Disc key : lights.keys) {
    key.radiance = glm::vec3(1.0f);
    sources.push_back({key, {}});
  }

  std::vector<spec::Disc> new_keys;
  std::vector<Source*> to_trace;
  for (Source& source : sources) {
    const auto found = std::ranges::find(kept, source.light, &Source::light);
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
    const auto* lamp = std::get_if<lighting::LocalLight>(&source->light);
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
  for (const lighting::LocalLight& lamp : lights.lamps) powers.push_back(lamp.power);
  for (const spec::Disc& key : lights.keys) powers.push_back(key.radiance);
  sources_ = shineAll(lights, kept);
  const bool same_sources = std::ranges::equal(sources_, kept, {}, &Source::light, &Source::light);
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
