// Payload LightWeights: from which light probes each sample of a cell is lit, and how much from each.
// Incident light at sample p is Σ_k weight_k / 255 x light of light probe k, over up to four of the cell's
// list. Sources: Sloan, Kautz and Snyder 2002, section 6 (several light probes, blended per vertex). Errors:
// wrong length, an index past the cell's list, weights that do not sum to 255.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::bundle {

inline constexpr std::size_t kLightsPerSample = 4;

struct LightWeights {
  std::array<std::uint8_t, kLightsPerSample> light{};   // place in Cell::light_probes
  std::array<std::uint8_t, kLightsPerSample> weight{};  // of 255, falling; they sum to 255
  bool operator==(const LightWeights&) const = default;
};

// All of the first light probe of the cell.
inline constexpr LightWeights kOneLight{{}, {255}};

// Eight runs of one byte per sample: light 0, ..., light 3, weight 0, ..., weight 3.
std::vector<std::byte> encodeLightWeights(std::span<const LightWeights> samples);
Result<std::vector<LightWeights>> decodeLightWeights(std::span<const std::byte> bytes,
                                                     std::size_t sample_count, std::size_t light_count,
                                                     const std::string& subject);

}  // namespace lambent::bundle
