// Arranges the transfer at samples into the vectors that a cell's payloads hold
// (runtime/transfer/codebook.hpp). Light of the environment and light of the group's own lights have separate
// vectors; in each, transfer without bounces ("shadowed") and with them ("full") stands side by side. Only of
// glossy cells, visibility and bounced light of the environment are coded by themselves.
#pragma once

#include <vector>

#include "baker/effects/surface/bounces.hpp"
#include "baker/trace/transfer_field.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::baker {

struct CellVectors {
  transfer::TransferShape shape;
  std::vector<float> vectors;  // [sample][shape.size()]
};

// Returns the vectors of the environment (of a glossy cell visibility, then bounced light if some reaches
// it), then those of the group's lights if there are any. `bounced` is null without bounces; if no bounced
// light reaches the cell, there is no full block. `grey` says which columns of direct light have no colour.
std::vector<CellVectors> cellVectors(const SampleCell& cell, const SampleSet& samples,
                                     const DirectResult& direct, const BounceResult* bounced,
                                     GreyColumns grey);

}  // namespace lambent::baker
