// How rows of vertices are stored, encoder and decoder side by side, so that they cannot drift; and the
// entropy coder of all payloads. codebook.hpp has the codes of cells. Byte tables: docs/format.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::bundle {

// Vertex v is the weighted sum over entries [offsets[v], offsets[v+1]). Weights of a vertex sum to 1.
struct VertexWeights {
  std::vector<std::uint32_t> offsets;  // vertex_count + 1, starts at 0, never falls
  std::vector<std::uint32_t> samples;  // sample of the group
  std::vector<float> weights;          // stored as unorm16, 0..1
};

std::vector<std::byte> encodeRows(const VertexWeights& rows);
// Errors name `subject`: sizes that do not add up, samples >= sample_count.
Result<VertexWeights> decodeRows(std::span<const std::byte> bytes, std::uint32_t vertex_count,
                                 std::uint32_t sample_count, const std::string& subject);

std::vector<std::byte> compressZstd(std::span<const std::byte> bytes, int level);
Result<std::vector<std::byte>> decompressZstd(std::span<const std::byte> bytes, std::size_t raw_length,
                                              const std::string& subject);

}  // namespace lambent::bundle
