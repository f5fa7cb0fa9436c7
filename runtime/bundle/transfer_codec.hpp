// The lossless half of transfer storage: encoder and decoder of each payload side by side, so that they
// cannot drift. (Which planes to keep and how finely to quantize them is decided in baker/compress.) Byte
// tables: docs/format.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::bundle {

// --- vertex rows
// ----------------------------------------------------------------------------------------------- Vertex v is
// the weighted sum over entries [offsets[v], offsets[v+1]). Weights of a vertex sum to 1.
struct VertexRows {
  std::vector<std::uint32_t> offsets;  // vertex_count + 1, starts at 0, never falls
  std::vector<std::uint32_t> samples;  // sample of the group
  std::vector<float> weights;          // stored as unorm16, 0..1
};

std::vector<std::byte> encodeRows(const VertexRows& rows);
// Errors name `subject`: sizes that do not add up, samples >= sample_count.
Result<VertexRows> decodeRows(std::span<const std::byte> bytes, std::uint32_t vertex_count,
                              std::uint32_t sample_count, const std::string& subject);

// --- basis
// ----------------------------------------------------------------------------------------------------- (1 +
// planes) vectors of channels x columns floats, the mean first; binary16 in the file. Layout of a vector:
// channel-major, [channel * columns + column].
std::vector<std::byte> encodeBasis(std::span<const float> vectors);
Result<std::vector<float>> decodeBasis(std::span<const std::byte> bytes, std::size_t value_count,
                                       const std::string& subject);

// --- weight planes
// --------------------------------------------------------------------------------------------- One unsigned
// integer of plane.bits bits per sample, little endian; codes are what the GPU reads.
std::vector<std::byte> encodePlane(std::span<const std::uint32_t> codes, std::uint32_t bits);
Result<std::vector<std::uint32_t>> decodePlane(std::span<const std::byte> bytes, std::uint32_t bits,
                                               std::uint32_t sample_count, const std::string& subject);

// --- whole cells
// ----------------------------------------------------------------------------------------------- Transfer
// vectors of one cell, sample-major: [(sample * channels + channel) * columns + column]. The CPU twin of what
// the diffuse effect decodes in its shader; `planes` may be a prefix of transfer.planes.
std::vector<float> decodeTransfer(const DiffuseTransfer& transfer, std::uint32_t sample_count,
                                  std::span<const float> basis,
                                  std::span<const std::vector<std::uint32_t>> planes);

// --- entropy coding
// --------------------------------------------------------------------------------------------
std::vector<std::byte> compressZstd(std::span<const std::byte> bytes, int level);
Result<std::vector<std::byte>> decompressZstd(std::span<const std::byte> bytes, std::size_t raw_length,
                                              const std::string& subject);

}  // namespace lambent::bundle
