// What falls on the patches of a rigid group straight from a near light: the closed forms by which pixels are
// shaded (near_light_ref.hpp), times the share of the lamp that rays from it see. Blockers are the patches'
// own triangles and those of other bodies. No GL.
#pragma once

#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/lighting/near_light.hpp"
#include "runtime/lighting/patches.hpp"

namespace lambent::frame {

// E/pi at each patch for unit power, mean over its points. others: what else may stand in the way, in the
// group's frame. On several threads; does not depend on how many.
std::vector<float> lampOnPatches(const lighting::NearLight& light, const lighting::Patches& patches,
                                 std::span<const lighting::RayTriangle> others,
                                 const glm::mat4& world_from_group);

}  // namespace lambent::frame
