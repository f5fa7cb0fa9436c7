// Encodes and decodes the rows of vertices, which say from which samples each vertex takes its light, and how
// much from each. docs/format.md has the byte tables.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::transfer {

// Transfer at vertex v is the weighted sum of samples over entries [offsets[v], offsets[v+1]). The weights of
// a vertex sum to 1.
struct VertexWeights {
  std::vector<std::uint32_t> offsets;  // vertex_count + 1 entries, starting at 0 and never falling
  std::vector<std::uint32_t> samples;  // samples of the group
  std::vector<float> weights;          // stored as unorm16, 0..1
};

std::vector<std::byte> encodeRows(const VertexWeights& rows);
// Fails, naming `subject`, if sizes do not add up or a sample is not below sample_count.
Result<VertexWeights> decodeRows(std::span<const std::byte> bytes, std::uint32_t vertex_count,
                                 std::uint32_t sample_count, const std::string& subject);

}  // namespace lambent::transfer
