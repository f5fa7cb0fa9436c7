// From transfer at samples to the vectors that a cell's payloads hold (runtime/transfer/codebook.hpp): light
// of the environment and light of the group's own lights apart, without bounces ("shadowed") and with them
// ("full") side by side.
#pragma once

#include <vector>

#include "baker/effects/diffuse/bounces.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::baker {

struct CellVectors {
  transfer::TransferShape shape;
  std::vector<float> vectors;  // sample-major, shape.size() each
};

// Of the environment first, then, where there are some, of the group's lights. `bounced` is null without
// bounces; where nothing of them reaches the cell it has no full block.
std::vector<CellVectors> cellVectors(const SampleCell& cell, const SampleSet& samples,
                                     const DirectResult& direct, const BounceResult* bounced,
                                     bool grey_emission);

}  // namespace lambent::baker
