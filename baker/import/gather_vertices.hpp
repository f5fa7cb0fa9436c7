// Copies all attributes of a mesh at once, so that code which drops, doubles or sorts vertices forgets none.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Reorders the vertices of `mesh` as `sources`, which may repeat some and leave others out. Indices stay
// unchanged.
void gatherVertices(bundle::MeshData& mesh, std::span<const std::uint32_t> sources);

}  // namespace lambent::baker
