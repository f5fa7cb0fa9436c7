// The space in which coding errors are measured. A transfer vector scaled value by value with roots[i] has
// errors whose squares add up to the relative square error of shaded radiance: the energy of each block of
// the cell (shadowed light, full light) is 1 there, so that one number bounds both. Also the judge of coded
// vectors.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "baker/compress/light_weights.hpp"
#include "runtime/bundle/codebook.hpp"

namespace lambent::baker {

struct WeightedSpace {
  std::vector<double> roots;  // per value of a vector; 0 where the cell has no energy
  double blocks = 1.0;        // what the square errors of all blocks add up to where each is 1
};

// shown_energy, kernel_power: as CodingSettings.
WeightedSpace weightedSpace(std::span<const float> vectors, const bundle::TransferShape& shape,
                            double shown_energy, const BandPower& kernel_power);

// Weight of errors in the shadowed block beside a full one. Noise that spreads evenly over the space would
// leave it a smaller share of its bound than the full block, which has more values; with this both come out
// alike (measured: 0.8 and 0.9 cost more bytes, 1 % and 0.5 %).
inline constexpr double kShadowedRoot = 0.85;

}  // namespace lambent::baker
