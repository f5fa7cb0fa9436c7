// Decides whether a scene needs the diffuse effect. direct.hpp and bounces.hpp compute its transfer,
// baker/compress codes it, and the runtime's room of the same name shades from it.
#pragma once

#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

// Diffuse transfer is chosen for every scene with a surface.
EffectChoice chooseDiffuse(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
