// These structs are what the bakes of a volume and of a neighborhood hand to the bundle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "baker/compress/cpca.hpp"

namespace lambent::baker {

// A CodedCell holds samples that are coded together: at most 64 Ki, in the order of the grid.
struct CodedCell {
  std::uint32_t count = 0;
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // group frame
  std::vector<CodedTransfer> transfers;          // as in bundle::Cell
};

// BakedVolume is bundle::VolumeGrid with its payloads as values.
struct BakedVolume {
  glm::uvec3 size{1};
  glm::mat4 group_from_grid{1.0f};
  std::uint32_t bits = 8;
  std::vector<std::byte> density;  // codes
  float density_max = 0.0f;        // m^-1
  glm::vec3 albedo{1.0f};
  float g = 0.0f;
  glm::uvec3 transfer_size{1};
  std::vector<std::uint32_t> voxels;  // one per sample, ascending
  std::vector<CodedCell> cells;
  glm::vec3 light_probe{0.0f};  // where incoming light is sampled, group frame

  // Returns the bounds of the box of voxels in the group frame.
  std::pair<glm::vec3, glm::vec3> bounds() const {
    glm::vec3 low(group_from_grid[3]), high = low;
    for (int corner = 1; corner < 8; ++corner) {
      const glm::vec3 at = glm::vec3(size) * glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::vec3 place(group_from_grid * glm::vec4(at, 1.0f));
      low = glm::min(low, place), high = glm::max(high, place);
    }
    return {low, high};
  }
};

// BakedNeighborhood is bundle::NeighborhoodGrid with its payloads as values.
struct BakedNeighborhood {
  glm::uvec3 size{2};
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // group frame
  std::vector<CodedCell> cells;
};

}  // namespace lambent::baker
