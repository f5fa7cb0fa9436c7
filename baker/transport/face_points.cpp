#include "baker/transport/face_points.hpp"

#include <algorithm>
#include <cmath>

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

FacePoint facePoint(const GroupGeometry& geometry, const glm::uvec3& corners, const glm::vec3& weights) {
  const glm::vec3 a = geometry.positions[corners.x], b = geometry.positions[corners.y],
                  c = geometry.positions[corners.z];
  const glm::vec3 across = glm::cross(b - a, c - a);
  const float twice_area = glm::length(across);
  const glm::vec3 face = across / twice_area;
  const glm::vec3 at = weights.x * a + weights.y * b + weights.z * c;
  const glm::vec3 normal = interpolatedNormal(geometry, corners, weights);
  return {.position = at,
          .normal = normal == glm::vec3(0.0f) ? face : normal,
          .origin = {.position = at + standOff(at, std::sqrt(0.5f * twice_area)) * face,
                     .geometric_normal = face,
                     .weight = 1.0f,
                     .reach = reachOf(corners, geometry)}};
}

FacePoints facePoints(const GroupGeometry& geometry, const SampleSet& samples,
                      std::span<const std::uint32_t> triangles) {
  FacePoints points;
  SampleSet& set = points.samples;
  set.origin_offsets.push_back(0);
  const auto append = [&](const SampleStretch& stretch) {
    const std::size_t begin = set.size();
    for (const std::uint32_t t : triangles) {
      const glm::uvec3 corners = geometry.triangles[t];
      const std::uint32_t sample = samples.vertex_sample[corners.x];
      if (sample < stretch.begin || sample >= stretch.end) continue;
      if (!(triangleArea(geometry, corners) > 0.0)) continue;
      const FacePoint point = facePoint(geometry, corners, glm::vec3(1.0f / 3.0f));
      points.triangles.push_back(t);
      set.positions.push_back(point.position);
      set.normals.push_back(point.normal);
      if (glm::dot(point.normal, point.origin.geometric_normal) > 0.0f) set.origins.push_back(point.origin);
      set.origin_offsets.push_back(static_cast<std::uint32_t>(set.origins.size()));
    }
    return SampleStretch{begin, set.size()};
  };
  set.diffuse = append(samples.diffuse);
  set.normal_mapped = append(samples.normal_mapped);
  set.glossy = append(samples.glossy);
  return points;
}

}  // namespace lambent::baker
