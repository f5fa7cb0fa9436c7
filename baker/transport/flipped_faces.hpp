// Finds faces that are turned over: slivers that scanning and decimation leave, whose fronts look into the
// body. They are only seen from behind, but they lie on the faces beside them like lids, and a vertex under
// one would spread its darkness over all faces around it.
#pragma once

#include <cstdint>
#include <vector>

#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

// Returns 1 for each triangle of a single-sided draw that faces away from the normals of at least two of its
// corners, else 0. If these make up more than a hundredth of a draw's area they are no accident, and none
// counts.
std::vector<std::uint8_t> findFlippedFaces(const GroupGeometry& geometry);

}  // namespace lambent::baker
