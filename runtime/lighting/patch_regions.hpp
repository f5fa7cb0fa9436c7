// Owns the regions of a rigid group: its patches, and coarser parts of the same triangles that contain
// several patches, like the levels of a mip map. A ray that stands for a solid angle looks up the mean over
// what it covers; otherwise a few rays or none would hit a small bright spot. Regions are numbered: first the
// patches, in their order. All positions are in the group's frame. No GL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/lighting/patches.hpp"

namespace lambent::lighting {

class PatchRegions {
 public:
  PatchRegions() = default;
  explicit PatchRegions(const Patches& patches);

  std::size_t size() const { return patch_count_ + members_.size(); }
  // Returns how many levels the triangle has. Level 0 holds its patches.
  std::size_t levelsOf(std::size_t triangle) const { return levels_[triangle].size(); }
  std::size_t regionAt(const RayHit& hit, std::size_t level) const;
  float areaOf(std::size_t triangle, std::size_t level) const;
  // Returns the corners of that region, drawn in a little so that rays to them do not graze its neighbours.
  std::array<glm::vec3, 3> cornersAt(const RayHit& hit, std::size_t level) const;

  // Returns a value for each region: the mean of the values of its patches.
  std::vector<glm::vec3> means(std::span<const glm::vec3> by_patch) const;

 private:
  struct Level {
    std::uint32_t parts = 1;  // how many parts an edge has
    std::size_t first = 0;    // the number of the first region
  };
  std::vector<std::vector<Level>> levels_;           // indexed by triangle
  std::vector<std::array<glm::vec3, 3>> corners_;    // indexed by triangle
  std::vector<std::vector<std::uint32_t>> members_;  // the patches of each coarser region
  std::size_t patch_count_ = 0;
};

}  // namespace lambent::lighting
