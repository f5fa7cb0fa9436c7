// What a bundle takes on the GPU, told from its description: in each arena, in bytes. Residency makes its
// pages no larger, and what follows the camera (parts.hpp) counts by it.
#pragma once

#include <cstdint>

#include "runtime/bundle/description.hpp"

namespace lambent::streaming {

// All that is written for a vertex of a draw: E/pi, or for normal maps light of bands 0..2; RGB floats.
// Glossy ones take their samples at each pixel.
constexpr std::uint32_t radianceWords(std::uint32_t outputs) {
  return bundle::isGlossy(outputs) ? 0 : 3 * outputs;
}

// Of a sample, where its cell is lit from several light probes.
inline constexpr std::uint32_t kLightWeightWords = 2;

// Codes of a plane, a block of its own.
std::uint64_t planeBytes(const bundle::WeightPlane& plane);
// The codebook as the kernels read it (diffuse_shared.h), and the positions of the samples.
std::uint64_t codebookBytesOnGpu(const bundle::CellTransfer& transfer, std::uint32_t sample_count);
std::uint64_t cellBytes(const bundle::Cell& cell);
// vec4s of shaded samples.
std::uint64_t samplesOf(const bundle::Group& group);

// Of the density as the GPU has it, 16 bits a voxel.
constexpr std::uint64_t densityBytes(const glm::uvec3& size) {
  return std::uint64_t{2} * size.x * size.y * size.z;
}
// And the list of voxels.
std::uint64_t volumeBytes(const bundle::VolumeGrid& grid, std::uint64_t sample_count);
// What the light in a volume takes, in half floats: a texel per voxel of the transfer grid and output.
std::uint64_t volumeLightBytes(const bundle::Group& group);

// Of a group that is drawn by its capture proxy alone (frame/proxy_lods.hpp), at most.
inline constexpr std::uint64_t kProxyLodTriangleBytes = 64, kProxyLodGroupBytes = 208;
std::uint64_t proxyLodBytes(const bundle::Description& description, std::uint32_t group);

struct Needs {
  std::uint64_t geometry = 0, transfer = 0, samples = 0, rows = 0, radiance = 0, volumes = 0;

  std::uint64_t total() const { return geometry + transfer + samples + rows + radiance + volumes; }
};
// At most so much: rows are told by their length in the file.
Needs needsOf(const bundle::Description& description);

}  // namespace lambent::streaming
