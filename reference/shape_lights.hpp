// Spheres and discs of uniform radiance that light words put into the scene, as paths meet them. They are no
// surfaces: eye rays pass through them and they cast no shadow, but whatever stands before them does. Comes
// in: the lights, a point, two numbers or a direction. Goes out: a way to the light with its density per
// steradian: uniform over the cone that a sphere fills, uniform over the area of a disc; from inside a sphere
// there is none, since it stands in every direction. Radius 0 is never met.
#pragma once

#include <optional>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "runtime/sh/light_vector.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker::reference {

struct WayToLight {
  glm::vec3 dir{0.0f};  // unit
  float distance = 0.0f;
  glm::vec3 radiance{0.0f};
  float pdf = 0.0f;  // with which sampleShape() draws dir; 0: it never does
};

// None where nothing arrives, and from inside a sphere.
std::optional<WayToLight> sampleShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec2& u);

// What stands in the unit direction dir; none where that misses or meets a disc from behind.
std::optional<WayToLight> lookAtShape(const spec::LocalLight& light, const glm::vec3& point,
                                      const glm::vec3& dir);

// The first bands of what arrives at the point where nothing is in the way, as a light probe there has it.
sh::LightVector shapeLight(const spec::LocalLight& light, int order, const glm::vec3& point);

}  // namespace lambent::baker::reference
