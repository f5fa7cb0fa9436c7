#include "baker/transport/flipped_faces.hpp"

#include <algorithm>

#include <glm/geometric.hpp>

#include "baker/transport/sample_areas.hpp"

namespace lambent::baker {

namespace {

constexpr double kMostFolded = 0.01;  // share of a draw's area

}  // namespace

std::vector<std::uint8_t> findFlippedFaces(const GroupGeometry& geometry) {
  std::vector<std::uint8_t> flipped_faces(geometry.triangles.size(), 0);
  for (std::size_t d = 0; d < geometry.draws.size(); ++d) {
    const DrawGeometry& draw = geometry.draws[d];
    const bool two_sided = draw.back || (d + 1 < geometry.draws.size() && geometry.draws[d + 1].back);
    if (two_sided) continue;
    double area = 0.0, folded = 0.0;
    for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t) {
      const glm::uvec3& corners = geometry.triangles[t];
      const glm::vec3 normal = areaNormal(geometry, corners);
      int against = 0;
      for (int c = 0; c < 3; ++c) against += glm::dot(normal, geometry.normals[corners[c]]) < 0.0f;
      flipped_faces[t] = against >= 2;
      area += double{glm::length(normal)};
      if (flipped_faces[t] != 0) folded += double{glm::length(normal)};
    }
    if (folded > kMostFolded * area)
      std::fill_n(flipped_faces.begin() + draw.first_triangle, draw.triangle_count, std::uint8_t{0});
  }
  return flipped_faces;
}

}  // namespace lambent::baker
