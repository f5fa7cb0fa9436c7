// Decides what a glossy surface receives from directions that it would hide itself (docs/conventions.md,
// "Materials"). Its lobes follow the smooth normal and normal maps, so some of their directions lie below its
// plane. Such a direction sees what its mirror image sees.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker::reference {

// Horizons are two planes, given by unit normals. Directions below the plane of the smooth normal (before
// normal maps) are mirrored to above it; of these, directions that the triangle itself would hide are
// mirrored at the plane of the triangle. Rays start above the triangle, and each stands for all directions
// that see what it sees.
struct Horizons {
  glm::vec3 smooth{0.0f, 0.0f, 1.0f}, triangle{0.0f, 0.0f, 1.0f};

  static glm::vec3 mirrored(const glm::vec3& dir, const glm::vec3& normal) {
    return dir - 2.0f * glm::dot(dir, normal) * normal;
  }
  static glm::vec3 above(const glm::vec3& dir, const glm::vec3& normal) {
    return glm::dot(dir, normal) < 0.0f ? mirrored(dir, normal) : dir;
  }

  // Returns the ray that shows what a direction sees; it has the same length.
  glm::vec3 rayFor(const glm::vec3& dir) const { return above(above(dir, smooth), triangle); }

  // Calls visit(dir) with the directions above the smooth plane that a ray above the triangle stands for. The
  // ray also stands for their mirror images in that plane.
  template <typename Visit>
  void forAbove(const glm::vec3& ray, const Visit& visit) const {
    if (glm::dot(ray, smooth) > 0.0f) visit(ray);
    if (const glm::vec3 hidden = mirrored(ray, triangle); glm::dot(hidden, smooth) > 0.0f) visit(hidden);
  }
};

}  // namespace lambent::baker::reference
