// Computes which part of the world a key light's shadow map must show: the part that the camera sees, as seen
// from the light, and what stands between that and the light. World axes, metres. No GL.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/scene/bounds.hpp"

namespace lambent::frame {

// Returns the corners of the intersection of the box and the camera's frustum; empty if they do not meet.
std::vector<glm::dvec3> seenCorners(const scene::Box& box, const glm::mat4& clip_from_world);

// Describes an orthographic view along `towards` (unit, to the light); right, up and towards are
// right-handed. The map covers min to max along right and up, and depths from `top` down to `top - range`.
struct KeyRegion {
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, towards{0, 0, 1};
  glm::dvec2 min{0.0}, max{0.0};
  double top = 0.0, range = 0.0;

  // Sets min and max to the smallest area that shows these points and everything up to `top` that may block
  // their light.
  void enclose(std::span<const glm::dvec3> seen, double tan_radius);
  // Returns whether this region contains all of `other`.
  bool holds(const KeyRegion& other) const;
  double area() const { return (max.x - min.x) * (max.y - min.y); }
};

// Returns a region rotated about the light so that it is small, or nothing if there is nothing to see.
// Blockers reach up to `top` (along towards), and light also comes from directions up to tan_radius beside
// it, which widens the region.
std::optional<KeyRegion> regionOf(std::span<const glm::dvec3> seen, glm::dvec3 towards, double tan_radius,
                                  const scene::Box& casters);

}  // namespace lambent::frame
