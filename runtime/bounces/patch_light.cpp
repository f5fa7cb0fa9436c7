#include "runtime/bounces/patch_light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "runtime/base/threads.hpp"
#include "runtime/shadows/shadowed_light_record.hpp"
#include "runtime/shadows/shadowed_light_ref.hpp"

namespace lambent::frame {

namespace {

using lighting::Patch;
using lighting::ShadowedLight;

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

std::vector<glm::vec3> lampPoints(const ShadowedLight& light) {
  if (!hasExtent(light)) return {light.position_ws};
  std::vector<glm::vec3> points;
  if (light.kind == ShadowedLight::Kind::Sphere) {
    for (const glm::vec3& point : ballPoints()) points.push_back(light.position_ws + light.radius_m * point);
    return points;
  }
  glm::vec3 s, t;
  ref::localBasis(light.direction_ws, s, t);
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
  ref::localBasis(key.direction, s, t);
  std::vector<glm::vec3> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const float away =
        std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count)) * std::sin(radius);
    const float turn = 2.0f * std::numbers::pi_v<float> * std::numbers::phi_v<float> * static_cast<float>(i);
    rays.push_back(ref::localUnit(key.direction + away * (std::cos(turn) * s + std::sin(turn) * t)));
  }
  return rays;
}

// Returns what may block the lamp's light. Triangles within a spherical lamp that are no larger than it
// belong to the lamp itself.
lighting::TriangleTree blockersOf(const ShadowedLight& light, const lighting::Patches& patches,
                                  std::span<const lighting::RayTriangle> others,
                                  const glm::mat4& world_from_group) {
  const auto isLamp = [&](const lighting::RayTriangle& triangle) {
    return light.kind == ShadowedLight::Kind::Sphere &&
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

std::vector<float> lampOnPatches(const ShadowedLight& lamp, const lighting::Patches& patches,
                                 std::span<const lighting::RayTriangle> others,
                                 const glm::mat4& world_from_group) {
  ShadowedLight light = lamp;
  if (const float length = glm::length(light.direction_ws); length > 0.0f) light.direction_ws /= length;
  const ShadowedLightRecord record = recordOf(light, 0.0f);
  const std::vector<Patch>& all = patches.all();
  const glm::mat4 group_from_world = glm::inverse(world_from_group);
  const glm::mat3 world_from_normal = glm::transpose(glm::mat3(group_from_world));

  std::vector<glm::vec3> points_ws;  // slightly above their patches
  std::vector<float> shares;         // without blockers
  for (const Patch& patch : all) {
    const glm::vec3 normal_ws = ref::localUnit(world_from_normal * patch.normal);
    for (const glm::vec3& point : patch.points) {
      points_ws.emplace_back(world_from_group * glm::vec4(point, 1.0f));
      shares.push_back(ref::localShare(record, normal_ws, light.position_ws - points_ws.back()));
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
          const float share = ref::sphereShare(glm::dot(patch.normal, keys[k].direction),
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

}  // namespace lambent::frame
