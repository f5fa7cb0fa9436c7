#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "runtime/lighting/incident_light.hpp"

namespace lambent::lighting {

namespace {

// Returns how far points at unit distance from the origin may have moved, from the columns of rotation and
// scale.
float turnBetween(const glm::mat4& a, const glm::mat4& b) {
  float turn = 0.0f;
  for (int column = 0; column < 3; ++column)
    turn = std::max(turn, glm::distance(glm::vec3(a[column]), glm::vec3(b[column])));
  return turn;
}

}  // namespace

BodyChange changeOf(const IncidentBody& before, const glm::vec3& place_before, const IncidentBody& after,
                    const glm::vec3& place_after) {
  constexpr float kHalfTurn_rad = std::numbers::pi_v<float>;
  const float radius_m = after.radius_m;
  const auto drift = static_cast<float>(after.radiance_drift - before.radiance_drift);
  const glm::vec3 offset_before = before.center_ws - place_before,
                  offset_after = after.center_ws - place_after;
  const float moved = glm::distance(offset_before, offset_after) +
                      radius_m * turnBetween(before.body.world_from_proxy, after.body.world_from_proxy);
  const float distance = std::min(glm::length(offset_before), glm::length(offset_after));
  // Inside the body's sphere nothing can be ruled out.
  if (distance <= radius_m)
    return {.half_angle = kHalfTurn_rad, .angle = moved > 0.0f ? kHalfTurn_rad : 0.0f, .drift = drift};
  return {
      .half_angle = std::asin(radius_m / distance), .angle = moved / (distance - radius_m), .drift = drift};
}

float shareOfLight(const BodyChange& change, bool other, int order) {
  // A body that fills a share of the sphere contributes that share of the light's mean, and up to n times as
  // much in n bands (|y(d)|² = n²/4pi), but no more than all of it. Moved by an angle, its light differs from
  // itself by about n/2 times the angle (the parallax of a delta light), up to that of an unrelated light.
  const auto bands = static_cast<float>(order);
  constexpr float kOther = std::numbers::sqrt2_v<float>;
  const float parallax = other ? kOther : std::min(0.5f * bands * change.angle, kOther);
  const float share = std::min(0.5f * (1.0f - std::cos(change.half_angle)) * bands, 1.0f);
  return share * (parallax + change.drift);
}

bool passesLight(std::span<const LightQuery> queries, const glm::vec3& towards, float half_angle) {
  const float distance = glm::length(towards);
  return std::ranges::any_of(queries, [&](const LightQuery& query) {
    const float reach = half_angle + query.angular_radius_rad;
    return reach >= std::numbers::pi_v<float> || distance == 0.0f ||
           glm::dot(query.direction, towards) > distance * std::cos(reach);
  });
}

}  // namespace lambent::lighting
