// Decides whether a scene needs the glossy effect. glossy_direct.hpp and glossy_bounces.hpp compute its
// transfer matrices.
#pragma once

#include <vector>

#include "baker/effects/diffuse/diffuse.hpp"
#include "baker/effects/glossy/glossy_transport.hpp"
#include "baker/plan/effect_plan.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// Every scene with a surface that is not diffuse calls for glossy transfer.
EffectChoice chooseGlossy(const Scene& scene, const std::vector<RigidGroup>& groups);

// Arranges the transfer matrices at samples into the vectors that the payloads of a glossy cell hold:
// visibility, bounced light, and light of the group's own lights, each coded by itself
// (runtime/transfer/codebook.hpp).

// Returns visibility first, then bounced light if some reaches the cell, then the lights. `grey_emission`
// says that direct light of the lights has no colour.
std::vector<CellVectors> glossyCellVectors(const SampleCell& cell, const GlossyField& field,
                                           bool grey_emission);

}  // namespace lambent::baker
