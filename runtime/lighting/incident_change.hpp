// By how much the light that arrives at a place may have changed since bodies stood as they did: estimates,
// by which captures are drawn anew or not. No GL.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/lighting/capture_scene.hpp"

namespace lambent::lighting {

// It has to be drawn anew.
inline constexpr float kWhollyChanged = std::numeric_limits<float>::infinity();

struct BodyPose {
  std::uint64_t version = 0;  // no two poses ever have the same; equal versions are equal poses
  glm::mat4 world_from_proxy{1.0f};
  glm::vec3 center_ws{0.0f};
  // Sum of all changes of its radiance so far, each as a share of what it was.
  double radiance_drift = 0.0;
};

// How a body's sphere changed as seen from a place.
struct BodyChange {
  float half_angle = 0.0f, angle = 0.0f;  // radians: its own, and by which it moved
  float drift = 0.0f;                     // of its radiance
};

// All zero but the half angle where both are the same.
BodyChange changeOf(const BodyPose& before, const glm::vec3& place_before, const BodyPose& after,
                    const glm::vec3& place_after, float radius_m);

// Of the light's mean, in `order` bands. other: the body was not there before or is not there now.
float shareOfLight(const BodyChange& change, bool other, int order);

// Whether a body in this direction may hide part of a light that was asked for.
bool passesLight(std::span<const LightQuery> queries, const glm::vec3& towards, float half_angle);

}  // namespace lambent::lighting
