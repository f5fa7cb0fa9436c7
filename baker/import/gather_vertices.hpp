// All attributes of a mesh at once: whoever leaves vertices out, doubles or sorts them must forget none.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// The vertices of `mesh` in the order of `sources`, which may repeat some and leave others out. Indices stay.
void gatherVertices(bundle::MeshData& mesh, std::span<const std::uint32_t> sources);

}  // namespace lambent::baker
