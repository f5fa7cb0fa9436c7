// Refinement of meshes by halving edges. Whether an edge is halved must follow from its end points only, so
// that neighbours agree and no crack opens, also across seams of normals or texture coordinates.
#pragma once

#include <cstdint>
#include <functional>

#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Halves edges until none is longer than max_edge > 0, in mesh units. Attributes are interpolated, normals
// renormalised. Stops with `false` (mesh unchanged) if more than max_triangles would come out.
bool splitLongEdges(bundle::MeshData& mesh, float max_edge, std::size_t max_triangles);

// Halves, once, each edge for which `marked` says so, given the vertices at its ends in either order.
void splitMarkedEdges(bundle::MeshData& mesh,
                      const std::function<bool(std::uint32_t a, std::uint32_t b)>& marked);

}  // namespace lambent::baker
