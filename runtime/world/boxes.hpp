// Whether two boxes that stand anywhere in the world have a point in common.
#pragma once

#include <glm/mat4x4.hpp>

#include "runtime/scene/bounds.hpp"

namespace lambent::frame {

// A box and where its frame stands; affine. Empty boxes meet nothing. Exact but for rounding: separating axes
// (Gottschalk, Lin and Manocha 1996), of parallelepipeds, so that any affine placement will do.
bool meet(const scene::Box& a, const glm::mat4& world_from_a, const scene::Box& b,
          const glm::mat4& world_from_b);

}  // namespace lambent::frame
