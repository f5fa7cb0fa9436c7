// Decides which light a glossy surface gets from directions below its own plane (docs/conventions.md,
// "Materials"). Lobes follow the smooth normal and normal maps, so parts of them can lie below the triangle.
// Such a direction gets the light of its mirror image.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker::reference {

// Holds two planes by their unit normals. A direction below the plane of the smooth normal (before normal
// maps) is mirrored at it; if the result is below the triangle, it is mirrored at the triangle. Rays start
// above the triangle, and each stands for all directions that are mirrored to it.
struct Horizons {
  glm::vec3 smooth{0.0f, 0.0f, 1.0f}, triangle{0.0f, 0.0f, 1.0f};

  static glm::vec3 mirrored(const glm::vec3& dir, const glm::vec3& normal) {
    return dir - 2.0f * glm::dot(dir, normal) * normal;
  }
  static glm::vec3 above(const glm::vec3& dir, const glm::vec3& normal) {
    return glm::dot(dir, normal) < 0.0f ? mirrored(dir, normal) : dir;
  }

  // Returns the ray direction for a direction, with the same length.
  glm::vec3 rayFor(const glm::vec3& dir) const { return above(above(dir, smooth), triangle); }

  // Calls visit(dir) for the directions above the smooth plane that a ray stands for. The ray also stands for
  // their mirror images in that plane.
  template <typename Visit>
  void forAbove(const glm::vec3& ray, const Visit& visit) const {
    if (glm::dot(ray, smooth) > 0.0f) visit(ray);
    if (const glm::vec3 hidden = mirrored(ray, triangle); glm::dot(hidden, smooth) > 0.0f) visit(hidden);
  }
};

}  // namespace lambent::baker::reference
