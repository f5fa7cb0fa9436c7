// Measures triangles, and how much of the surface each sample stands for.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// Returns a normal that is twice the triangle's area long, in square metres.
glm::vec3 areaNormal(const GroupGeometry& geometry, const glm::uvec3& corners);
// Returns square metres.
double triangleArea(const GroupGeometry& geometry, const glm::uvec3& corners);
// Returns metres.
float longestEdge(const GroupGeometry& geometry, const glm::uvec3& corners);

// Returns square metres per sample; a third of each triangle goes to each of its corners, or all of it in
// equal parts to its texels. Both sides of a double-sided surface count.
std::vector<float> sampleAreas(const GroupGeometry& geometry, const SampleSet& samples);

// Makes samples inside faces, beside those at vertices. Transfer at them is what interpolation over the faces
// is fitted to (trace/vertex_fit.hpp).

struct FacePoints {
  SampleSet samples;                     // without vertices and cells
  std::vector<std::uint32_t> triangles;  // of each sample, into GroupGeometry::triangles
};

// A FacePoint is a point of a triangle as a sample.
struct FacePoint {
  glm::vec3 position, normal;  // interpolated; the normal is unit
  SampleOrigin origin;         // a little off the face
};
// `weights` are those of the corners and sum to 1. The triangle must have an area.
FacePoint facePoint(const GroupGeometry& geometry, const glm::uvec3& corners, const glm::vec3& weights);

// Returns the centroids of the triangles listed: first those of diffuse draws, then of normal-mapped and of
// glossy ones, as in SampleSet. Faces that turn away from their normal have no origins, since nobody sees
// their front. Triangles without area give no point.
FacePoints facePoints(const GroupGeometry& geometry, const SampleSet& samples,
                      std::span<const std::uint32_t> triangles);

}  // namespace lambent::baker
