// The baker's room of the neighborhood effect: does the scene call for it? Which groups: baker/plan/
// neighborhoods.hpp; what is computed: bake_neighborhood.hpp.
#pragma once

#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

EffectChoice chooseNeighborhood(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
