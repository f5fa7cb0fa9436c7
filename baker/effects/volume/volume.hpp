// Decides whether a scene needs the volume effect; volume_transfer.hpp computes its transfer.
#pragma once

#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

// The effect is chosen for every scene with a volume.
EffectChoice chooseVolume(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
