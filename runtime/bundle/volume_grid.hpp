// A volume (VolumeGrid in description.hpp) has two payloads:
//   "density": one code of 8 or 16 bits per voxel, little endian, x fastest, then y, then z, where
//              extinction = density_max * code / (2^bits - 1).
//   "voxels":  rising indices of voxels of the transfer grid (x fastest), each as its difference from the one
//              before it (the first from 0), as 32-bit integers in the form of payload_bytes.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"

namespace lambent::bundle {

std::vector<std::byte> encodeVoxels(std::span<const std::uint32_t> voxels);
// Fails, naming `subject`, if the voxels do not rise or lie outside the grid.
Result<std::vector<std::uint32_t>> decodeVoxels(std::span<const std::byte> bytes, const glm::uvec3& grid_size,
                                                const std::string& subject);

}  // namespace lambent::bundle
