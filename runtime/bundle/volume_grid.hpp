// Payloads of volumes (VolumeGrid in description.hpp).
//   "density": a code per voxel, x fastest, then y, then z; 8 or 16 bits, little endian;
//              extinction = density_max * code / (2^bits - 1)
//   "voxels":  voxels of the transfer grid, x fastest, rising; each as its difference from the one before
//   (the
//              first from 0), as 32-bit integers in the form of payload_bytes.hpp: four bytes a voxel
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
// Errors name `subject`: voxels that do not rise, or that the grid does not have.
Result<std::vector<std::uint32_t>> decodeVoxels(std::span<const std::byte> bytes, const glm::uvec3& grid_size,
                                                const std::string& subject);

}  // namespace lambent::bundle
