// Computes the GPU memory of a bundle from its description, in bytes for each arena. Residency limits its
// pages to these sizes, and parts.hpp counts with them.
#pragma once

#include <cstdint>

#include "runtime/bundle/description.hpp"
#include "runtime/transfer/seen_sky_shared.h"

namespace lambent::streaming {

// Returns the number of floats that are written per vertex of a draw: E/pi as RGB and the luminance of what
// comes straight from lights that are shaded per pixel, or light in bands 0..2 for normal maps as RGB. Glossy
// draws need none, since they use samples at each pixel.
constexpr std::uint32_t radianceWords(transfer::Form form) {
  if (form == transfer::Form::Vector) return 4;
  return form == transfer::Form::NormalMapped ? 3 * transfer::kMappedOutputs : 0;
}

// Returns the number of words per vertex that a draw keeps beside its mesh: these, and with a specular layer
// what it sees of the sky.
constexpr std::uint32_t vertexWords(transfer::Form form, bool layered) {
  return radianceWords(form) + (layered ? transfer::kSeenWords : 0);
}

// Words per sample if its cell has several light probes.
inline constexpr std::uint32_t kLightWeightWords = 2;

// Returns the size of a plane's codes, which are a block of their own.
std::uint64_t planeBytes(const bundle::WeightPlane& plane);
// Returns the size of a codebook as the kernels read it (transfer_shared.h), with the positions of the
// samples.
std::uint64_t codebookBytesOnGpu(const bundle::CellTransfer& transfer, std::uint32_t sample_count);
std::uint64_t cellBytes(const bundle::Cell& cell);
// Returns the number of vec4 for the shaded samples of a group.
std::uint64_t samplesOf(const bundle::Group& group);

// Returns the size of the density on the GPU, which has 16 bits per voxel.
constexpr std::uint64_t densityBytes(const glm::uvec3& size) {
  return std::uint64_t{2} * size.x * size.y * size.z;
}
// Returns the size of a square texture of E/pi with all mip levels.
std::uint64_t irradianceBytes(std::uint32_t side);
// Returns the size of the density and the list of voxels.
std::uint64_t volumeBytes(const bundle::VolumeGrid& grid, std::uint64_t sample_count);
// Returns the size of the light in a volume: a texel of half floats per voxel of the transfer grid and
// output.
std::uint64_t volumeLightBytes(const bundle::Group& group);

// Size limits for a group that is drawn as its capture proxy (surface/proxy_lods.hpp).
inline constexpr std::uint64_t kProxyLodTriangleBytes = 64, kProxyLodGroupBytes = 208;
// Returns an upper bound of the memory of such a group.
std::uint64_t proxyLodBytes(const bundle::Description& description, bundle::GroupIndex group);

struct Needs {
  std::uint64_t geometry = 0, transfer = 0, samples = 0, rows = 0, radiance = 0, textures = 0, volumes = 0;

  std::uint64_t total() const { return geometry + transfer + samples + rows + radiance + textures + volumes; }
};
// Returns upper bounds, since the sizes of rows are derived from their length in the file.
Needs needsOf(const bundle::Description& description);

}  // namespace lambent::streaming
