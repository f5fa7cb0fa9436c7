// Computes the light that falls directly on the patches of a rigid group from a local light or from key
// lights: the closed forms with which pixels are shaded (shadowed_light_ref.hpp), times the share of the
// light that rays find visible. Blockers are the patches' own triangles and those of other bodies. It uses
// several threads; results do not depend on how many. No GL.
#pragma once

#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "runtime/lighting/local_light.hpp"
#include "runtime/lighting/patches.hpp"
#include "runtime/spec/distant_lights.hpp"

namespace lambent::frame {

// Returns E/pi at each patch for unit power, averaged over the patch's points. `others` are further blockers
// in the group's frame.
std::vector<float> lampOnPatches(const lighting::ShadowedLight& light, const lighting::Patches& patches,
                                 std::span<const lighting::RayTriangle> others,
                                 const glm::mat4& world_from_group);

// Returns the same for discs at infinity of radiance 1: one list of all patches per disc. Directions are in
// the group's frame.
std::vector<std::vector<float>> keysOnPatches(std::span<const spec::Disc> keys,
                                              const lighting::Patches& patches,
                                              std::span<const lighting::RayTriangle> others);

}  // namespace lambent::frame
