// Uniform refinement: splits edges until none is longer than a limit. The decision depends on an edge's end
// points only, so neighbours agree and no crack opens, also across seams of normals or texture coordinates.
#pragma once

#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// max_edge > 0 in mesh units. Attributes are interpolated, normals renormalised. Stops with `false` (mesh
// unchanged) if more than max_triangles would come out.
bool splitLongEdges(bundle::MeshData& mesh, float max_edge, std::size_t max_triangles);

}  // namespace lambent::baker
