// Which part of the world a key light's shadow map must show: the part that is seen, as the light sees it,
// and what stands between that and the light. World axes, metres. No GL.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/scene/bounds.hpp"

namespace lambent::frame {

// The corners of what is both in the box and in the camera's view; empty where nothing is.
std::vector<glm::dvec3> seenCorners(const scene::Box& box, const glm::mat4& clip_from_world);

// An orthographic view along `towards` (unit, to the light): right, up and towards are right-handed. Places
// run from min to max along right and up, depth from `top` downwards over `range`.
struct KeyRegion {
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, towards{0, 0, 1};
  glm::dvec2 min{0.0}, max{0.0};
  double top = 0.0, range = 0.0;

  // Makes min and max the least that show these points, with all that may stand in their light up to `top`.
  void enclose(std::span<const glm::dvec3> seen, double tan_radius);
  // Whether all that `other` shows lies within.
  bool holds(const KeyRegion& other) const;
  double area() const { return (max.x - min.x) * (max.y - min.y); }
};

// Turned about the light so that it is small. Blockers stand up to `top` (along towards) and light comes from
// directions up to tan_radius beside it, which widens what must be seen. None where there is nothing to see.
std::optional<KeyRegion> regionOf(std::span<const glm::dvec3> seen, glm::dvec3 towards, double tan_radius,
                                  const scene::Box& casters);

}  // namespace lambent::frame
