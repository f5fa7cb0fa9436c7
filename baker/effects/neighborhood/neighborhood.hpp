// Decides whether a scene needs the neighborhood effect. baker/plan/neighborhoods.hpp chooses the groups, and
// bake_neighborhood.hpp computes their transfer.
#pragma once

#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

EffectChoice chooseNeighborhood(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
