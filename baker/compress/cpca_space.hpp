// The space in which coding errors are measured. A transfer vector scaled value by value with roots[i] has
// errors whose squares add up to the relative square error of shaded radiance: the energy of each block of
// the cell (shadowed light, full light) is 1 there, so that one number bounds both. Also the judge of coded
// vectors.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "runtime/bundle/codebook.hpp"

namespace lambent::baker {

struct WeightedSpace {
  std::vector<double> roots;  // per value of a vector; > 0, or 0 where the cell has no energy
  bool dark = false;          // no energy at all
};

WeightedSpace weightedSpace(std::span<const float> vectors, const bundle::TransferShape& shape);

// Share of the square error that coding may leave in the shadowed block beside a full one: smaller than 1
// saves bits (full light is what is shown), and the shadowed block keeps the bound all the same since most of
// it is coded along with the full one.
inline constexpr double kShadowedRoot = 0.7;

}  // namespace lambent::baker
