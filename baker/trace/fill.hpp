// Samples that lie inside or under something are dark; interpolated, that darkness would leak out along the
// contact. They take the mean of their valid neighbours instead, layer by layer.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "baker/trace/transfer_field.hpp"

namespace lambent::baker {

// `edges` as sampleEdges() gives them. Returns how many samples were filled; what no valid sample is
// connected to keeps its value.
std::uint32_t fillFromNeighbours(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& edges,
                                 std::vector<std::uint8_t> valid, TransferField& field);

// The same for values of a stretch of the samples, from `first` on, `size` for each; edges to others do not
// count. `valid` is that of all samples.
std::uint32_t fillStretchFromNeighbours(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& edges,
                                        const std::vector<std::uint8_t>& valid, std::size_t first,
                                        std::size_t size, std::span<float> values);

}  // namespace lambent::baker
