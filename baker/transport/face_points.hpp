// Places inside faces, beside the vertices, where transfer is computed too: what interpolation over the faces
// is held against (effects/diffuse/vertex_fit.hpp).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

struct FacePoints {
  SampleSet samples;                     // of no vertices, in no cells
  std::vector<std::uint32_t> triangles;  // of each sample: into GroupGeometry::triangles
};

// A point of a triangle as a sample.
struct FacePoint {
  glm::vec3 position, normal;  // interpolated; the normal unit
  SampleOrigin origin;         // off the face
};
// weights: of the corners, summing to 1. The triangle has an area.
FacePoint facePoint(const GroupGeometry& geometry, const glm::uvec3& corners, const glm::vec3& weights);

// The centroids of the triangles listed: of plain ones, then of normal-mapped, then of glossy ones, as
// SampleSet has them. Folds, of which nobody sees the front, have no origins. A triangle without area has no
// point.
FacePoints facePoints(const GroupGeometry& geometry, const SampleSet& samples,
                      std::span<const std::uint32_t> triangles);

}  // namespace lambent::baker
