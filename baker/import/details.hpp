// Says how fine the details of a mesh are. Positions are coded on a lattice whose step follows the size of
// what is coded together, and a step near the length of edges bends shapes.
#pragma once

#include "baker/import/scene.hpp"

namespace lambent::baker {

// Returns the length that the longest edges of nearly all triangles reach.
float detailOf(const bundle::MeshData& mesh);

// Returns whether rounding to multiples of the step bends shapes with edges of this length.
inline bool bends(float step, float detail) {
  return step > detail / 128.0f;
}

// Divides primitives whose fine parts would be bent by a lattice for the whole: exporters join a ball and the
// ground of 10 km under it into one. The farther from the origin, the coarser are floats, so fine parts are
// put together by their distance.
void separateDetails(SceneMesh& mesh);

}  // namespace lambent::baker
