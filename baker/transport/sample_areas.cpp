#include "baker/transport/sample_areas.hpp"

#include <algorithm>

#include <glm/geometric.hpp>

namespace lambent::baker {

glm::vec3 areaNormal(const GroupGeometry& geometry, const glm::uvec3& corners) {
  const glm::vec3 a = geometry.positions[corners.x];
  return glm::cross(geometry.positions[corners.y] - a, geometry.positions[corners.z] - a);
}

double triangleArea(const GroupGeometry& geometry, const glm::uvec3& corners) {
  return 0.5 * double{glm::length(areaNormal(geometry, corners))};
}

float longestEdge(const GroupGeometry& geometry, const glm::uvec3& corners) {
  const glm::vec3 &a = geometry.positions[corners.x], &b = geometry.positions[corners.y],
                  &c = geometry.positions[corners.z];
  return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
}

std::vector<float> sampleAreas(const GroupGeometry& geometry, const SampleSet& samples) {
  std::vector<float> areas(samples.size(), 0.0f);
  std::vector<std::uint32_t> texels_of(samples.texels.empty() ? 0 : geometry.triangles.size(), 0);
  for (const TexelMap& map : samples.texels)
    for (std::size_t i = 0; i < map.sample_of.size(); ++i)
      if (map.sample_of[i] != kNoSample) ++texels_of[map.triangle_of[i]];
  for (const TexelMap& map : samples.texels)
    for (std::size_t i = 0; i < map.sample_of.size(); ++i)
      if (const std::uint32_t t = map.triangle_of[i]; map.sample_of[i] != kNoSample)
        areas[map.sample_of[i]] +=
            static_cast<float>(triangleArea(geometry, geometry.triangles[t]) / texels_of[t]);
  for (std::size_t t = 0; t < geometry.triangles.size(); ++t) {
    if (!texels_of.empty() && texels_of[t] > 0) continue;  // it is that of its texels
    const glm::uvec3& triangle = geometry.triangles[t];
    const glm::vec3 a = geometry.positions[triangle.x], b = geometry.positions[triangle.y],
                    c = geometry.positions[triangle.z];
    const float third = glm::length(glm::cross(b - a, c - a)) / 6.0f;
    for (int corner = 0; corner < 3; ++corner) areas[samples.vertex_sample[triangle[corner]]] += third;
  }
  return areas;
}

}  // namespace lambent::baker
