// A surface in fewer triangles, by meshoptimizer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

struct SimpleMesh {
  std::vector<glm::vec3> positions;  // as GroupGeometry::positions, each used
  std::vector<glm::uvec3> triangles;
  float error_m = 0.0f;  // how far the surface may lie from the one that it was made of
};

// The triangles as they are, vertices at the same place welded (but for rounding).
SimpleMesh welded(const GroupGeometry& geometry, std::span<const std::uint32_t> triangles);

// At most `most` triangles, 4 or more, and at least one if there was one with an area: by edge collapses
// (Garland and Heckbert 1997); where the surface's topology stands against that, by clusters of vertices; and
// where it is lost in these, its bounding box or tetrahedron.
SimpleMesh simplified(const SimpleMesh& mesh, std::size_t most);

}  // namespace lambent::baker
