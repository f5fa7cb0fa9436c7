// Samples the sphere and disc lights of uniform radiance that light words add to a scene. They are no
// surfaces: eye rays pass through them and they cast no shadow, but surfaces in front of them block their
// light. A light, a point, and two random numbers or a direction come in. A direction to the light with its
// density per steradian goes out: uniform over the cone of a sphere, or uniform over the area of a disc.
// Inside a sphere there is no such density, because it fills all directions. A light of radius 0 is never
// hit.
#pragma once

#include <optional>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "runtime/sh/light_vector.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker::reference {

// A WayToLight is a direction from a point towards a light.
struct WayToLight {
  glm::vec3 dir{0.0f};  // unit
  float distance = 0.0f;
  glm::vec3 radiance{0.0f};
  float pdf = 0.0f;  // density with which sampleShape() draws dir; 0 if it cannot
};

// Samples a direction towards the light. Returns nothing if no light arrives, and inside a sphere.
std::optional<WayToLight> sampleShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec2& u);

// Returns what the unit direction dir sees, or nothing if it misses the light or hits the back of a disc.
std::optional<WayToLight> lookAtShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec3& dir);

// Returns the first SH bands of the unoccluded light at the point, as a light probe there would store it.
sh::LightVector shapeLight(const spec::LocalLight& light, int order, const glm::vec3& point);

}  // namespace lambent::baker::reference
