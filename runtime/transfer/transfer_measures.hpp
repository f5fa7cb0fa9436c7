// Computes numbers that describe the transfer at one sample, for views of it and their tests. It is the CPU
// twin of transfer_values.comp. It takes a decoded transfer vector (decodeTransfer). For matrices (normal
// maps, glossy surfaces) a number is the mean over all directions of the normal, so that unoccluded surfaces
// of every kind have the same numbers. Only light from the environment counts. No GL; any thread; no errors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "runtime/sh/gaunt.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::transfer {

inline constexpr float kY00 = 0.28209479177387814f;

// A_l/pi, the cosine's weights. Outputs of a matrix are convolved with those of bands 0..2.
inline constexpr std::array<float, 8> kCosineOverPi = {1.0f,          2.0f / 3.0f, 0.25f,        0.0f,
                                                       -1.0f / 24.0f, 0.0f,        1.0f / 64.0f, 0.0f};

// Returns the value of an unoccluded surface: E/pi = A_0/pi y_00 under the light whose only coefficient is
// l_00 = 1.
constexpr float openDc() {
  return kY00;
}
// Returns the sum over m of ((A_l/pi) y_lm(n))² = (A_l/pi)² (2l + 1) / 4 pi, which does not depend on n.
constexpr float openBandEnergy(std::uint32_t band) {
  const float weight = band < kCosineOverPi.size() ? kCosineOverPi[band] : 0.0f;
  return weight * weight * static_cast<float>(2 * band + 1) / (4.0f * std::numbers::pi_v<float>);
}
// Returns the value at the end of the legend: that of unoccluded surfaces or, in bands where it is almost 0,
// a typical value due to shadows.
constexpr float usualBandEnergy(std::uint32_t band) {
  constexpr float kOfShadows = 0.01f;
  const float open = openBandEnergy(band);
  return open > kOfShadows ? open : kOfShadows;
}

// Selects a block of the vector.
struct TransferBlock {
  std::uint32_t first = 0, channels = 1;
};
inline TransferBlock blockOf(const transfer::TransferShape& shape, bool full) {
  if (full && shape.full_channels > 0)
    return {shape.shadowed_channels * shape.outputs * shape.columns(), shape.full_channels};
  return {0, shape.shadowed_channels};
}

// Returns E/pi under the light whose only coefficient is l_00 = 1, averaged over channels.
inline float transferDc(const transfer::TransferShape& shape, const TransferBlock& block,
                        std::span<const float> vector) {
  if (shape.isVisibility()) return kY00 * kY00 * vector[0];
  float sum = 0.0f;
  for (std::uint32_t c = 0; c < block.channels; ++c)
    sum += vector[block.first + c * shape.outputs * shape.columns()];
  return (shape.outputs > 1 ? kY00 : 1.0f) * sum / static_cast<float>(block.channels);
}

// Returns the sum of squares of the coefficients of a band, averaged over channels. For a row of E/pi this is
// the band's energy; for a matrix M it is that of sum_j (A_j/pi) y_j(n) M_jk, averaged over n: (1/4 pi)
// sum_j<9 (A_j/pi)² sum_m M_j,lm².
inline float transferBandEnergy(const transfer::TransferShape& shape, const TransferBlock& block,
                                std::span<const float> vector, std::uint32_t band) {
  if (band >= shape.order) return 0.0f;
  const std::uint32_t columns = shape.order * shape.order, first = band * band, count = 2 * band + 1;
  const auto energyOf = [&](std::span<const float> rows, std::uint32_t outputs, std::uint32_t stride) {
    if (outputs == 1) {
      float sum = 0.0f;
      for (std::uint32_t m = 0; m < count; ++m) sum += rows[first + m] * rows[first + m];
      return sum;
    }
    float sum = 0.0f;
    for (std::uint32_t j = 0; j < transfer::kMappedOutputs; ++j) {
      const float weight = kCosineOverPi[j == 0 ? 0 : j < 4 ? 1 : 2];
      for (std::uint32_t m = 0; m < count; ++m) {
        const float value = weight * rows[j * stride + first + m];
        sum += value * value;
      }
    }
    return sum / (4.0f * std::numbers::pi_v<float>);
  };
  if (shape.isVisibility()) {
    const sh::GauntTable table = sh::makeGauntTable(static_cast<int>(shape.order), 3);
    std::vector<float> matrix(std::size_t{transfer::kMappedOutputs} * columns);
    sh::addVisibilityMatrix(table, vector, matrix);
    return energyOf(matrix, transfer::kMappedOutputs, columns);
  }
  float sum = 0.0f;
  for (std::uint32_t c = 0; c < block.channels; ++c)
    sum += energyOf(vector.subspan(block.first + std::size_t{c} * shape.outputs * shape.columns()),
                    shape.outputs, shape.columns());
  return sum / static_cast<float>(block.channels);
}

}  // namespace lambent::transfer
