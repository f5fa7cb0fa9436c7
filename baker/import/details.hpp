// Divides triangles into connected parts, and tells which of them are closed. Triangles are given by the
// numbers of their corners (plan/group_lights.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>

#include "baker/import/scene.hpp"

namespace lambent::baker {

using CornerTriangle = std::array<std::uint32_t, 3>;

// Returns the indices of the triangles of each part. Triangles that share a corner belong together. Corners
// are numbered from 0 to `corners` - 1.
std::vector<std::vector<std::size_t>> connectedParts(std::span<const CornerTriangle> triangles,
                                                     std::size_t corners);

// Returns whether each edge of the part is passed as often in one direction as in the other. Edges without
// length do not count.
bool isClosed(std::span<const CornerTriangle> triangles, std::span<const std::size_t> part);

// Boxes in double of what nodes place in the world.

inline double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

struct PlacedBox {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

  bool empty() const { return low.x > high.x; }
  glm::dvec3 center() const { return 0.5 * (low + high); }
  double side() const { return largest(high - low); }
  double diagonal() const { return empty() ? 0.0 : glm::distance(low, high); }
  bool contains(const glm::dvec3& point) const {
    return glm::all(glm::lessThan(low, point)) && glm::all(glm::lessThan(point, high));
  }
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

// Says how fine the details of a mesh are. Positions are coded on a lattice whose step follows the size of
// what is coded together, and a step near the length of edges bends shapes.

// Returns the length that the longest edges of nearly all triangles reach.
float detailOf(const bundle::MeshData& mesh);

// Returns whether rounding to multiples of the step bends shapes with edges of this length.
inline bool bends(float step, float detail) {
  return step > detail / 128.0f;
}

// Divides primitives whose fine parts would be bent by a lattice for the whole: exporters join a ball and the
// ground of 10 km under it into one. The farther from the origin, the coarser are floats, so fine parts are
// put together by their distance.
void separateDetails(SceneMesh& mesh);

}  // namespace lambent::baker
