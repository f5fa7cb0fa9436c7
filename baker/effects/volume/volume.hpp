// The baker's room of the volume effect: does the scene call for it? Transfer is computed in
// volume_transfer.hpp.
#pragma once

#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

// Every scene with a volume calls for it.
EffectChoice chooseVolume(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
