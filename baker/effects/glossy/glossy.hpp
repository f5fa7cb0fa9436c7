// Decides whether a scene needs the glossy effect. glossy_direct.hpp and glossy_bounces.hpp compute its
// transfer matrices.
#pragma once

#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

// Every scene with a surface that is not diffuse calls for glossy transfer.
EffectChoice chooseGlossy(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
