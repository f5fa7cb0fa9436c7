// Simplifies a surface to fewer triangles, by meshoptimizer.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
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

// Measures how large a surface looks from far away.

class Silhouette {
 public:
  explicit Silhouette(std::span<const SimpleMesh> original);

  // Returns by how much `proxy` must grow, as a length, to cover as much as the original does, seen from far
  // away along seven axes (mean of areas). Of the proxy, only what lies within the original's bounds counts.
  // Returns 1 if either covers nothing; the result is within 1/2..2.
  float scaleOf(std::span<const SimpleMesh> proxy) const;

 private:
  struct View {
    glm::vec3 right{0.0f}, up{0.0f};
    glm::vec2 low{0.0f}, high{0.0f};  // bounds of the original
    double pixel = 0.0;               // square metres; 0 if seen edge on
    double covered = 0.0;             // pixels
  };
  static double pixelsOf(std::span<const SimpleMesh> meshes, const View& view);

  std::array<View, 7> views_;
};

}  // namespace lambent::baker
