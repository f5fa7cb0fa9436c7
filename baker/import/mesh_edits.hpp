// Copies all attributes of a mesh at once, so that code which drops, doubles or sorts vertices forgets none.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Reorders the vertices of `mesh` as `sources`, which may repeat some and leave others out. Indices stay
// unchanged.
void gatherVertices(bundle::MeshData& mesh, std::span<const std::uint32_t> sources);

// Removes vertices that no triangle has.
void dropUnusedVertices(bundle::MeshData& mesh);

// Appends a vertex whose attributes are the weighted means of those of others; the weights sum to 1. Normals
// keep the length of their mean (MeshData::normal_weights), so that interpolation over parts of a triangle
// equals that over the whole.
template <std::size_t N>
void appendMean(bundle::MeshData& mesh, const std::array<std::uint32_t, N>& of,
                const std::array<float, N>& weights);
extern template void appendMean(bundle::MeshData&, const std::array<std::uint32_t, 2>&,
                                const std::array<float, 2>&);
extern template void appendMean(bundle::MeshData&, const std::array<std::uint32_t, 3>&,
                                const std::array<float, 3>&);

// Makes the tangents of meshes whose files have none, by the rules of MikkTSpace (Mikkelsen 2008), which glTF
// 2.0 asks for and with which most programs bake normal maps.

// `map` says which texture coordinates are used, and how they are transformed. A vertex around which the
// picture is mirrored becomes two. Does nothing without texture coordinates. The mesh has normals.
void makeTangents(bundle::MeshData& mesh, const gltf::TextureRef& map);

// Refines meshes by splitting edges. Whether and where an edge is split must follow from its end points only,
// so that neighbours agree and no crack opens, also across seams of normals or texture coordinates.

// Splits edges until none is longer than max_edge > 0, in mesh units. Attributes are interpolated, normals
// renormalised. Returns false, with the mesh unchanged, if there would be more than max_triangles.
bool splitLongEdges(bundle::MeshData& mesh, float max_edge, std::size_t max_triangles);

// Splits each marked edge once. `share` gets the vertices at its ends in either order, and returns 0 if the
// edge is not marked, else where it is split: this share of the way from a to b. It must return exactly
// 1 - share if the ends change places.
void splitMarkedEdges(bundle::MeshData& mesh,
                      const std::function<float(std::uint32_t a, std::uint32_t b)>& share);

}  // namespace lambent::baker
