// Finds out whether an emissive material shines as a few spheres, such as bulbs and glowing balls. The direct
// light of spheres can be shaded per pixel, which shows the sharp shadows that values at vertices blur. What
// a scene's material emits in a rigid group comes in, spheres in the group's frame come out.
#pragma once

#include <cstdint>
#include <vector>

#include "baker/import/scene.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

// Returns the spheres, at most bundle::kMaxLampSpheres, or nothing if the material has an emissive texture or
// if any part of its surfaces in the group is not about a sphere that is closed and emits outwards.
std::vector<bundle::LampSphere> findLampSpheres(const Scene& scene, const RigidGroup& group,
                                                std::uint32_t material);

}  // namespace lambent::baker
