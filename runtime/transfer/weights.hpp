// Weights that blend: those of the samples from which a vertex takes its light, and those of the light probes
// from which a sample takes its own.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::transfer {

// Encodes and decodes the rows of vertices, which say from which samples each vertex takes its light, and how
// much from each. docs/format.md has the byte tables.

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

// The payload LightWeights says how each sample of a cell blends its light probes. The incident light at a
// sample is Σ_k weight_k / 255 x (light at probe k) over up to four probes of the cell's list (Sloan, Kautz
// and Snyder 2002, section 6: several probes, blended per vertex).
inline constexpr std::size_t kLightsPerSample = 4;

struct LightWeights {
  std::array<std::uint8_t, kLightsPerSample> light{};   // positions in Cell::light_probes
  std::array<std::uint8_t, kLightsPerSample> weight{};  // falling; they sum to 255
  bool operator==(const LightWeights&) const = default;
};

// These weights take all light from the cell's first probe.
inline constexpr LightWeights kOneLight{{}, {255}};

// The payload is eight runs of one byte per sample: light 0, ..., light 3, weight 0, ..., weight 3. Decoding
// fails, naming `subject`, if the length is wrong, a probe is not in the cell's list of `light_count` probes,
// or weights do not sum to 255.
std::vector<std::byte> encodeLightWeights(std::span<const LightWeights> samples);
Result<std::vector<LightWeights>> decodeLightWeights(std::span<const std::byte> bytes,
                                                     std::size_t sample_count, std::size_t light_count,
                                                     const std::string& subject);

}  // namespace lambent::transfer
