// Chooses the places of reflection probes in a rigid group: points in its air from which they see what the
// rest of the room sees. It reads which voxels of the group's box its surfaces pass through. A point counts
// as inside a room if most directions from it meet surfaces. A statue under the open sky has no such points,
// so it gets no probes. The same input gives the same places. No GL; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::lighting {

// Holds a byte for each voxel of a grid of cubes: towards which sides the surfaces that pass through it face.
struct SurfaceVoxels {
  static constexpr int kLongest = 40;  // voxels along the longest edge of the box

  glm::vec3 origin{0.0f};  // corner of voxel (0, 0, 0)
  float edge_m = 0.0f;     // of a voxel
  glm::ivec3 count{0};     // along each axis
  // Four voxels per word, the first in the lowest byte. Bits 0, 1 and 2: some surface faces towards +X, +Y or
  // +Z, 4, 5 and 6: towards -X, -Y or -Z.
  std::vector<std::uint32_t> words;

  // Makes an empty grid that covers a box, with a voxel of margin. The box must not be empty.
  static SurfaceVoxels over(const glm::vec3& box_min, const glm::vec3& box_max);
  std::size_t placeOf(const glm::ivec3& voxel) const {
    return static_cast<std::size_t>((voxel.z * count.y + voxel.y) * count.x + voxel.x);
  }
  std::uint32_t at(const glm::ivec3& voxel) const {
    const std::size_t place = placeOf(voxel);
    return words[place / 4] >> (8 * (place % 4)) & 0xffu;
  }
  // Adds a surface with this normal.
  void add(const glm::ivec3& voxel, const glm::vec3& normal);
};

// Returns at most `most` places in the frame of the voxels, the one that sees most first. Returns nothing if
// the surfaces enclose no room.
std::vector<glm::vec3> chooseProbePlaces(const SurfaceVoxels& voxels, std::size_t most);

}  // namespace lambent::lighting
