// What a glossy surface takes for light that it would itself hide (docs/conventions.md, "Materials"): its
// lobes lean with the smooth normal and with normal maps, so some of their directions lie below its plane.
// What stands in the way of such a direction is what its mirror image sees.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker::reference {

// Two planes, by unit normals: of the smooth normal, unbent by normal maps, in which directions below it are
// mirrored to those above; and of the triangle, in which those of the latter are that the triangle itself
// would hide. Rays start above the triangle, and each stands for all directions that see what it sees.
struct Horizons {
  glm::vec3 smooth{0.0f, 0.0f, 1.0f}, triangle{0.0f, 0.0f, 1.0f};

  static glm::vec3 mirrored(const glm::vec3& dir, const glm::vec3& normal) {
    return dir - 2.0f * glm::dot(dir, normal) * normal;
  }
  static glm::vec3 above(const glm::vec3& dir, const glm::vec3& normal) {
    return glm::dot(dir, normal) < 0.0f ? mirrored(dir, normal) : dir;
  }

  // The ray that tells what a direction sees, of the same length.
  glm::vec3 rayFor(const glm::vec3& dir) const { return above(above(dir, smooth), triangle); }

  // Calls visit(dir) with the directions above the smooth plane that a ray above the triangle stands for. It
  // stands for their mirror images in that plane, too.
  template <typename Visit>
  void forAbove(const glm::vec3& ray, const Visit& visit) const {
    if (glm::dot(ray, smooth) > 0.0f) visit(ray);
    if (const glm::vec3 hidden = mirrored(ray, triangle); glm::dot(hidden, smooth) > 0.0f) visit(hidden);
  }
};

}  // namespace lambent::baker::reference
