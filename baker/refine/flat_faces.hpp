// Gives large flat faces regular triangles. Tools of architects cut walls and ceilings into fans of slivers
// around windows, whose corners are the wrong places for light, and splits of their edges stay slivers. Such
// a face becomes one polygon that is filled with a grid, finer along its rim and along the lines where other
// surfaces stand on it or go through it. There each side has vertices of its own, so that no light leaks from
// one to the other.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "baker/importance/importance.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "baker/refine/group_refiner.hpp"
#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

struct SeenTriangle {
  double share = 0.0;   // of all pictures
  double excess = 0.0;  // of the square error there, times the share, over what is allowed
};

// Changes the meshes that a group draws, as far as `room` new vertices go; faces with the greatest excess
// come first, and those without any stay. `geometry` is that of the group, `seen` has its triangles, and
// `importance` is of the same surfaces. Meshes that are drawn more than once, or whose texels have samples,
// stay. Faces that share an edge with one that is filled are split where its vertices lie.
void fillFlatFaces(const RigidGroup& group, const GroupGeometry& geometry, const CopiesOfMeshes& copies,
                   const Importance& importance, std::span<const SeenTriangle> seen, std::size_t room,
                   std::vector<std::vector<bundle::MeshData>>& meshes);

}  // namespace lambent::baker
