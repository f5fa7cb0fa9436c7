// Estimates by how much the light that arrives at a place may have changed since bodies had their earlier
// poses. These estimates decide which captures are drawn again. No GL.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/lighting/capture_scene.hpp"

namespace lambent::lighting {

// This value means that the light must be captured again.
inline constexpr float kWhollyChanged = std::numeric_limits<float>::infinity();

struct BodyPose {
  std::uint64_t version = 0;  // unique per pose: equal versions are equal poses
  glm::mat4 world_from_proxy{1.0f};
  glm::vec3 center_ws{0.0f};
  // Sums all relative changes of its radiance so far.
  double radiance_drift = 0.0;
};

// Describes the change of a body's bounding sphere as seen from a place.
struct BodyChange {
  float half_angle = 0.0f, angle = 0.0f;  // radians: apparent radius, and the angle by which it moved
  float drift = 0.0f;                     // relative change of its radiance
};

// Returns the change between two poses; all but the half angle is zero if both are the same.
BodyChange changeOf(const BodyPose& before, const glm::vec3& place_before, const BodyPose& after,
                    const glm::vec3& place_after, float radius_m);

// Returns the change relative to the light's mean, in `order` bands. `other` tells that the body appeared or
// disappeared.
float shareOfLight(const BodyChange& change, bool other, int order);

// Returns whether a body in this direction may hide part of a light in `queries`.
bool passesLight(std::span<const LightQuery> queries, const glm::vec3& towards, float half_angle);

}  // namespace lambent::lighting
