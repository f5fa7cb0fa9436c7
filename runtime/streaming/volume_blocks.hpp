// Computes the largest density in blocks of 8 x 8 x 8 voxels, so that rays can skip empty blocks. The density
// is linear between voxel centres, so the maximum of a block includes the voxels next to it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::streaming {

inline constexpr std::uint32_t kVolumeBlock = 8;  // voxels per side

// Returns the number of blocks along each axis. Block b fills [8 b, 8 b + 8] in voxel coordinates.
inline glm::uvec3 blocksOf(const glm::uvec3& size) {
  return (size + glm::uvec3(kVolumeBlock - 1)) / kVolumeBlock;
}

// Returns the maxima as fractions of the largest code of `bits` (8 or 16), x fastest. `codes` are those of
// bundle::VolumeGrid.
std::vector<float> blockMaxima(std::span<const std::byte> codes, std::uint32_t bits, const glm::uvec3& size);

}  // namespace lambent::streaming
