// Decides whether a scene needs the diffuse and the glossy effect. direct.hpp and bounces.hpp compute their
// transfer, baker/compress codes it, and the runtime's rooms of the same names shade from it.
#pragma once

#include <vector>

#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

// Diffuse transfer is chosen for every scene with a surface.
EffectChoice chooseDiffuse(const Scene& scene, const std::vector<RigidGroup>& groups);

// Every scene with a surface that is not diffuse calls for glossy transfer.
EffectChoice chooseGlossy(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
