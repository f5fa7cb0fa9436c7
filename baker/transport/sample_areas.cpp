#include "baker/transport/sample_areas.hpp"

#include <algorithm>

#include <glm/geometric.hpp>

namespace lambent::baker {

double triangleArea(const GroupGeometry& geometry, const glm::uvec3& corners) {
  const glm::vec3 a = geometry.positions[corners.x];
  return 0.5 * double{glm::length(
                   glm::cross(geometry.positions[corners.y] - a, geometry.positions[corners.z] - a))};
}

float longestEdge(const GroupGeometry& geometry, const glm::uvec3& corners) {
  const glm::vec3 &a = geometry.positions[corners.x], &b = geometry.positions[corners.y],
                  &c = geometry.positions[corners.z];
  return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
}

std::vector<float> sampleAreas(const GroupGeometry& geometry, const SampleSet& samples) {
  std::vector<float> areas(samples.size(), 0.0f);
  for (const glm::uvec3& triangle : geometry.triangles) {
    const glm::vec3 a = geometry.positions[triangle.x], b = geometry.positions[triangle.y],
                    c = geometry.positions[triangle.z];
    const float third = glm::length(glm::cross(b - a, c - a)) / 6.0f;
    for (int corner = 0; corner < 3; ++corner) areas[samples.vertex_sample[triangle[corner]]] += third;
  }
  return areas;
}

}  // namespace lambent::baker
