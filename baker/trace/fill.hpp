// Fills in samples that lie inside or under something. They are dark, and interpolated, that darkness would
// leak out along the contact. They take the mean of their valid neighbours instead, layer by layer.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "baker/trace/transfer_field.hpp"

namespace lambent::baker {

// `edges` are those of sampleEdges(). Returns how many samples were filled. Samples that no valid sample is
// connected to keep their value.
std::uint32_t fillFromNeighbours(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& edges,
                                 std::vector<std::uint8_t> valid, TransferField& field);

// Does the same for the samples from `first` on alone, with `size` values each; edges to other samples do not
// count. `valid` has one entry for each sample of the whole set.
std::uint32_t fillStretchFromNeighbours(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& edges,
                                        const std::vector<std::uint8_t>& valid, std::size_t first,
                                        std::size_t size, std::span<float> values);

}  // namespace lambent::baker
