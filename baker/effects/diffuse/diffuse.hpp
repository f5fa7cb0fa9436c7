// Decides whether a scene needs the diffuse effect. direct.hpp and bounces.hpp compute its transfer,
// baker/compress codes it, and the runtime's room of the same name shades from it.
#pragma once

#include <vector>

#include "baker/effects/diffuse/bounces.hpp"
#include "baker/plan/effect_plan.hpp"
#include "baker/trace/transfer_field.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::baker {

// Diffuse transfer is chosen for every scene with a surface.
EffectChoice chooseDiffuse(const Scene& scene, const std::vector<RigidGroup>& groups);

// Arranges the transfer at samples into the vectors that a cell's payloads hold
// (runtime/transfer/codebook.hpp). Light of the environment and light of the group's own lights have separate
// vectors; in each, transfer without bounces ("shadowed") and with them ("full") stands side by side.

struct CellVectors {
  transfer::TransferShape shape;
  std::vector<float> vectors;  // [sample][shape.size()]
};

// Returns the vectors of the environment, then those of the group's lights if there are any. `bounced` is
// null without bounces; if no bounced light reaches the cell, there is no full block. `grey` says which
// columns of direct light have no colour.
std::vector<CellVectors> cellVectors(const SampleCell& cell, const SampleSet& samples,
                                     const DirectResult& direct, const BounceResult* bounced,
                                     GreyColumns grey);

}  // namespace lambent::baker
