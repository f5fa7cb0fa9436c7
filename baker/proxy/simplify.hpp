// Simplifies a surface to fewer triangles, by meshoptimizer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

struct SimpleMesh {
  std::vector<glm::vec3> positions;  // as GroupGeometry::positions; each is used
  std::vector<glm::uvec3> triangles;
  float error_m = 0.0f;  // how far it may lie from the surface that it was made of
};

// Returns the triangles as they are, with vertices at the same place (but for rounding) welded.
SimpleMesh welded(const GroupGeometry& geometry, std::span<const std::uint32_t> triangles);

// Returns at most `most` triangles (4 or more), and at least one if any has an area. It collapses edges
// (Garland and Heckbert 1997); if the topology does not allow that, it clusters vertices; and if that loses
// the surface, it returns its bounding box or a tetrahedron. Where fewer triangles stay within allowed_m of
// the mesh, it returns these.
SimpleMesh simplified(const SimpleMesh& mesh, std::size_t most, float allowed_m = 0.0f);

}  // namespace lambent::baker
