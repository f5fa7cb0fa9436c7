// Tells whether two boxes placed anywhere in the world overlap.
#pragma once

#include <glm/mat4x4.hpp>

#include "runtime/scene/bounds.hpp"

namespace lambent::frame {

// Returns whether the boxes have a point in common; empty boxes never do. The placements may be any affine
// transforms, because the test uses separating axes of parallelepipeds (Gottschalk, Lin and Manocha 1996). It
// is exact but for rounding.
bool meet(const scene::Box& a, const glm::mat4& world_from_a, const scene::Box& b,
          const glm::mat4& world_from_b);

}  // namespace lambent::frame
