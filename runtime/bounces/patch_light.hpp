// What falls on the patches of a rigid group straight from a local light or from key lights: the closed forms
// by which pixels are shaded (shadowed_light_ref.hpp), times the share of the light that rays see. Blockers
// are the patches' own triangles and those of other bodies. On several threads; results do not depend on how
// many. No GL.
#pragma once

#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/lighting/patches.hpp"
#include "runtime/lighting/shadowed_light.hpp"
#include "runtime/spec/distant_lights.hpp"

namespace lambent::frame {

// E/pi at each patch for unit power, mean over its points. others: what else may stand in the way, in the
// group's frame.
std::vector<float> lampOnPatches(const lighting::ShadowedLight& light, const lighting::Patches& patches,
                                 std::span<const lighting::RayTriangle> others,
                                 const glm::mat4& world_from_group);

// The same of discs at infinity, each of radiance 1: first all patches of the first disc. Directions are in
// the group's frame.
std::vector<std::vector<float>> keysOnPatches(std::span<const spec::Disc> keys,
                                              const lighting::Patches& patches,
                                              std::span<const lighting::RayTriangle> others);

}  // namespace lambent::frame
