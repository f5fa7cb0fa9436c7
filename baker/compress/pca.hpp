// Codes the transfer vectors of one cell as mean + few axes (principal components) with quantized weights per
// sample, so that the relative RMS error of shaded radiance over real lights stays under a bound:
//   sqrt( sum_s sum_i W_i (t_s,i - t'_s,i)² / sum_s sum_i W_i t_s,i² ) <= bound,
// W_i the band power of light (light_weights.hpp). Planes of weights come by falling variance: any prefix
// renders. Deterministic: fixed summation order, signs of axes fixed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/bundle/description.hpp"

namespace lambent::baker {
inline namespace single_cluster {  // until cpca.hpp takes its place: there are types of the same names there

struct CodedPlane {
  bundle::WeightPlane plane;  // payload is set by whoever stores the codes
  std::vector<std::uint32_t> codes;
};

struct CodedTransfer {
  std::vector<std::byte> basis;  // bundle::encodeBasis of mean and axes
  std::vector<CodedPlane> planes;
  float error = 0.0f;  // measured on the decoded vectors
};

// vectors: [sample][channel][column], `count` samples; order² columns per channel. bound > 0.
CodedTransfer codeTransfer(std::span<const float> vectors, std::size_t count, int order,
                           std::uint32_t channels, float bound);

// The error that codeTransfer bounds.
double radianceError(std::span<const float> truth, std::span<const float> coded, int order,
                     std::uint32_t channels);

}  // namespace single_cluster
}  // namespace lambent::baker
