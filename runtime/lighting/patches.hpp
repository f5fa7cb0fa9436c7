// Owns the surfaces of a rigid group as patches that exchange light: the triangles of its patch surface
// (runtime/bundle/capture_proxy.hpp), split into smaller ones, most of them where they matter to pictures. A
// patch sends one radiance in all directions. All positions are in the group's frame. No GL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/lighting/triangle_tree.hpp"

namespace lambent::lighting {

inline constexpr std::size_t kMaxPatches = 4096;
inline constexpr std::size_t kPatchPoints = 4;

// Names a part of a triangle whose edges are cut into `parts`. The triangle then has parts² parts, in rows of
// constant weight of the third corner; a row alternates between lower and upper triangles.
struct TrianglePart {
  std::uint32_t column = 0, row = 0;
  bool upper = false;
  // Returns the part that contains the point with weight b of the second corner and c of the third.
  static TrianglePart at(std::uint32_t parts, float b, float c);
  std::size_t place(std::uint32_t parts) const {
    return std::size_t{row} * (2 * parts - row) + 2 * std::size_t{column} + (upper ? 1 : 0);
  }
};

struct Patch {
  std::array<glm::vec3, kPatchPoints> points{};   // each represents a quarter of the area
  std::array<glm::vec3, kPatchPoints> origins{};  // start points of rays for `points`
  glm::vec3 normal{0.0f, 1.0f, 0.0f};
  float area = 0.0f;
  glm::vec3 albedo{0.0f};
};

class Patches {
 public:
  Patches() = default;
  // Makes at least one patch per triangle, about `most` in total.
  explicit Patches(const bundle::PatchSurface& surface, std::size_t most = kMaxPatches);

  const std::vector<Patch>& all() const { return patches_; }
  std::size_t size() const { return patches_.size(); }
  // Returns the triangles that were split, in their order.
  const TriangleTree& tree() const { return tree_; }
  std::size_t patchAt(const RayHit& hit) const;
  // Return the range of a triangle's patches, which are contiguous.
  std::size_t firstOf(std::size_t triangle) const { return split_[triangle].first; }
  std::size_t countOf(std::size_t triangle) const {
    return std::size_t{partsOf(triangle)} * partsOf(triangle);
  }
  // Returns into how many parts each edge is cut.
  std::uint32_t partsOf(std::size_t triangle) const { return split_[triangle].parts; }
  // Returns the diagonal of the bounds, or of the part that matters to pictures.
  float extent() const { return extent_; }
  // Returns how far the patches may be from the surface that they represent.
  float error() const { return error_; }
  // Returns a point slightly above the surface from which rays may start. A point of the true surface may lie
  // a little behind the patches, or behind a wall beside them; it is then moved in front. `normal` is that of
  // the surface.
  glm::vec3 inFront(glm::vec3 point, const glm::vec3& normal) const;

 private:
  // Each edge of a triangle is cut into `parts`, so that it has parts² patches from `first` on.
  struct Split {
    std::size_t first = 0;
    std::uint32_t parts = 1;
  };
  // Returns how far beyond an edge of the triangle the point lies, seen along the triangle's normal; 0 over
  // it.
  float beside(std::size_t triangle, const glm::vec3& point) const;

  std::vector<Patch> patches_;
  std::vector<Split> split_;        // one per triangle
  std::vector<glm::vec3> normals_;  // of the triangles
  TriangleTree tree_;
  float extent_ = 0.0f, error_ = 0.0f;
};

// Owns the regions of a rigid group: its patches, and coarser parts of the same triangles that contain
// several patches, like the levels of a mip map. A ray that stands for a solid angle looks up the mean over
// what it covers; otherwise a few rays or none would hit a small bright spot. Regions are numbered: first the
// patches, in their order. All positions are in the group's frame. No GL.
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
