// The baker's room of the diffuse effect: does the scene call for it? What it computes is in direct.hpp, what
// it stores in baker/compress; the runtime's room of the same name shades from that.
#pragma once

#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

// Every scene with a surface calls for diffuse transfer.
EffectChoice chooseDiffuse(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
