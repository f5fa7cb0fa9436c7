// The space in which coding errors are measured. If a transfer vector is scaled value by value with roots[i],
// the squares of its errors add up to the relative square error of shaded radiance. The energy of each block
// of the cell (shadowed light, full light) is 1 in this space, so that one number bounds both. The measure of
// coded vectors, radianceError, is implemented here too.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "baker/compress/light_weights.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::baker {

// Returns how much the square error of each sample counts: 1 / (ε + x), x being the sample's brightness
// relative to the RMS of all, scaled so that the energy of all samples together stays what it is. An eye that
// has adapted to a room sees errors relative to what is there, and not to what stands in the window. It is 1
// for parts that are shown together with others (CodingSettings::shown_energy, visibility), since the
// brightness of one part says too little. `weights` multiply it, unless they are empty
// (CodingSettings::weights).
std::vector<float> sampleImportance(std::span<const float> vectors, const transfer::TransferShape& shape,
                                    double shown_energy, const BandPower& kernel_power,
                                    std::span<const float> weights);

struct WeightedSpace {
  std::vector<double> roots;  // one per value of a vector; 0 where the cell has no energy
  double blocks = 1.0;        // sum of the energies of all blocks, weighted as in `roots`
};

// `shown_energy` and `kernel_power` are as in CodingSettings.
WeightedSpace weightedSpace(std::span<const float> vectors, const transfer::TransferShape& shape,
                            double shown_energy, const BandPower& kernel_power);

// This is the weight of errors in the shadowed block beside a full one. Noise that spreads evenly over the
// space would give the shadowed block a smaller relative error, because the full block has more values; with
// this weight both come out alike (measured: 0.8 and 0.9 cost 1 % and 0.5 % more bytes).
inline constexpr double kShadowedRoot = 0.85;

}  // namespace lambent::baker
