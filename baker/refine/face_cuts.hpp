// Finds where another surface cuts an edge of a face. Such a face is lit on one side of the cut and dark on
// the other. No vertex may mix both, and none should lie in the cut: each side gets a vertex of its own, a
// little before it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/group_geometry.hpp"
#include "baker/transport/ray_scene.hpp"

namespace lambent::baker {

struct FaceEdge {
  std::uint32_t a, b, triangle;  // two vertices, and the triangle to which the edge belongs
};

class FaceCuts {
 public:
  // `scene` is what is seen by `rays`, which outlive this; vertices keep a distance from a cut that is
  // relative to `extent`.
  FaceCuts(const GroupGeometry& scene, const RayScene& rays, float extent);

  // Returns for each edge the share of the way from a to b at which it is split because another surface cuts
  // it, or 0, also if the way is longer than `longest`.
  std::vector<float> sharesOf(const GroupGeometry& geometry, std::span<const FaceEdge> edges,
                              float longest) const;

 private:
  const RayScene& rays_;
  std::vector<glm::vec3> normals_;  // of the scene's triangles; 0 for those without area
  float before_;                    // the distance of a vertex from a cut
};

}  // namespace lambent::baker
