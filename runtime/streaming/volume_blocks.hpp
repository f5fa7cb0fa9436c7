// A volume's density in blocks of 8 x 8 x 8 voxels, so that rays pass over what is empty. Of each block the
// largest density that is found anywhere in it: also that of the voxels around it, between which and its own
// the density is linear.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::streaming {

inline constexpr std::uint32_t kVolumeBlock = 8;  // voxels a side

// Along each axis; block b fills [8 b, 8 b + 8] in voxel coordinates.
inline glm::uvec3 blocksOf(const glm::uvec3& size) {
  return (size + glm::uvec3(kVolumeBlock - 1)) / kVolumeBlock;
}

// As shares of the largest code that `bits` (8 or 16) can say, x fastest. `codes` as in bundle::VolumeGrid.
std::vector<float> blockMaxima(std::span<const std::byte> codes, std::uint32_t bits, const glm::uvec3& size);

}  // namespace lambent::streaming
