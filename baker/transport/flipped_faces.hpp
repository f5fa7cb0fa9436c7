// Faces of a skin that are turned over: slivers that scanning and decimation leave, whose fronts look into
// the body. Nobody sees them, for they are seen from behind, but they lie on the faces beside them like lids.
// A vertex under one would spread its darkness over all faces around.
#pragma once

#include <cstdint>
#include <vector>

#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

// Per triangle 1 where it turns its back to the normals of two of its corners or of all, on draws of one
// side. Where that is more than a hundredth of a draw's area it is no accident, and none of them counts.
std::vector<std::uint8_t> findFlippedFaces(const GroupGeometry& geometry);

}  // namespace lambent::baker
