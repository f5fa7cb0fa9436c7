// Refines meshes by splitting edges in half. Whether an edge is split must follow from its end points only,
// so that neighbours agree and no crack opens, also across seams of normals or texture coordinates.
#pragma once

#include <cstdint>
#include <functional>

#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Splits edges until none is longer than max_edge > 0, in mesh units. Attributes are interpolated, normals
// renormalised. Returns false, with the mesh unchanged, if there would be more than max_triangles.
bool splitLongEdges(bundle::MeshData& mesh, float max_edge, std::size_t max_triangles);

// Splits each marked edge once. `marked` gets the vertices at its ends in either order.
void splitMarkedEdges(bundle::MeshData& mesh,
                      const std::function<bool(std::uint32_t a, std::uint32_t b)>& marked);

}  // namespace lambent::baker
