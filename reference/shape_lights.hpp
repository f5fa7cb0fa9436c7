// These are the spheres and discs of uniform radiance that light words put into the scene, as paths meet
// them. They are no surfaces: eye rays pass through them and they cast no shadow, but surfaces in front of
// them block them. A light, a point, and two numbers or a direction come in. A direction to the light with
// its density per steradian goes out: uniform over the cone that a sphere fills, or uniform over the area of
// a disc. Inside a sphere there is no such density, since it fills all directions. A light of radius 0 is
// never met.
#pragma once

#include <optional>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "runtime/sh/light_vector.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker::reference {

// WayToLight is a direction from a point in which a light is seen.
struct WayToLight {
  glm::vec3 dir{0.0f};  // unit
  float distance = 0.0f;
  glm::vec3 radiance{0.0f};
  float pdf = 0.0f;  // density with which sampleShape() draws dir; 0 if it never does
};

// Returns nothing if no light arrives, and inside a sphere.
std::optional<WayToLight> sampleShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec2& u);

// Returns what the unit direction dir sees; nothing if it misses the light or meets a disc from behind.
std::optional<WayToLight> lookAtShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec3& dir);

// Returns the first bands of what arrives at the point if nothing is in the way, as a light probe there would
// have it.
sh::LightVector shapeLight(const spec::LocalLight& light, int order, const glm::vec3& point);

}  // namespace lambent::baker::reference
