#include "runtime/shadows/shadowed_light_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include "runtime/scene/affine.hpp"

namespace lambent::frame {

namespace {

// The share falls to 0 over this last part of the distance.
constexpr float kFadePart = 1.0f / 6.0f;

}  // namespace

bool standsWithin(const scene::Box& bounds, const glm::mat4& world_from_group,
                  const lighting::LocalLight& light) {
  if (bounds.empty() || light.kind == lighting::LocalLight::Kind::Directional) return false;
  const float scale = scene::largestScale(world_from_group);
  const float determinant = glm::determinant(glm::mat3(world_from_group));
  if (determinant == 0.0f || !std::isfinite(1.0f / determinant)) return false;
  const glm::vec3 place(glm::inverse(world_from_group) * glm::vec4(light.position_ws, 1.0f));
  const float reach = light.extent_m() / scale;
  return glm::all(glm::greaterThan(place, bounds.min - reach)) &&
         glm::all(glm::lessThan(place, bounds.max + reach));
}

float radiiFrom(const scene::Box& bounds, const glm::mat4& world_from_group,
                const lighting::LocalLight& light) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  if (bounds.empty() || light.kind == lighting::LocalLight::Kind::Directional) return kFar;
  const float radius = bounds.radius() * scene::largestScale(world_from_group);
  const glm::vec3 middle(world_from_group * glm::vec4(bounds.center(), 1.0f));
  const float distance = glm::distance(middle, light.position_ws);
  // Most lights are farther away than any corner of the bounds, enlarged by the light's own extent.
  const bool beyond = distance > 1.001f * (radius + std::numbers::sqrt3_v<float> * light.extent_m());
  if (!beyond && standsWithin(bounds, world_from_group, light)) return 0.0f;
  const float radii = std::max(distance - light.extent_m(), 0.0f) / radius;
  return std::isfinite(radii) ? std::max(radii, std::numeric_limits<float>::min()) : kFar;
}

std::vector<float> localShares(std::span<const float> radii_from, float radii) {
  std::vector<float> near;
  for (const float from : radii_from)
    if (from == 0.0f || from < radii) near.push_back(from);
  std::ranges::sort(near);
  const float limit = near.size() > lighting::kMaxShadowedLights ? near[lighting::kMaxShadowedLights] : radii;
  std::vector<float> shares(radii_from.size(), 0.0f);
  std::uint32_t count = 0;
  for (std::size_t k = 0; k < shares.size() && count < lighting::kMaxShadowedLights; ++k) {
    if (radii_from[k] == 0.0f)
      shares[k] = 1.0f;
    else if (radii_from[k] < limit)
      shares[k] = std::min((limit - radii_from[k]) / (kFadePart * limit), 1.0f);
    if (shares[k] > 0.0f) ++count;
  }
  return shares;
}

}  // namespace lambent::frame
