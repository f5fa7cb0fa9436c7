// Boxes in double of what nodes place in the world.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"

namespace lambent::baker {

inline double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

struct PlacedBox {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

  bool empty() const { return low.x > high.x; }
  glm::dvec3 center() const { return 0.5 * (low + high); }
  double side() const { return largest(high - low); }
  void add(const glm::dvec3& point) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
  // Adds the corners of another box, which is not empty, as the matrix places them.
  void add(const PlacedBox& box, const glm::dmat4& matrix) {
    for (int corner = 0; corner < 8; ++corner)
      add(glm::dvec3(matrix * glm::dvec4((corner & 1) ? box.high.x : box.low.x,
                                         (corner & 2) ? box.high.y : box.low.y,
                                         (corner & 4) ? box.high.z : box.low.z, 1.0)));
  }
};

inline PlacedBox boxOf(const SceneMesh& mesh) {
  PlacedBox box;
  for (const ScenePrimitive& primitive : mesh.primitives)
    for (const glm::vec3& position : primitive.mesh.positions) box.add(glm::dvec3(position));
  return box;
}

}  // namespace lambent::baker
