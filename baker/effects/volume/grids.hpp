// Looks up the density of a volume along rays. Density is linear between voxel centres, constant in the half
// voxel towards the faces of the box, and 0 outside. Optical depth is exact for it: within the cell between
// eight voxel centres density is a cubic of the distance, which Simpson's rule integrates without error.
// Blocks of 8 x 8 x 8 empty cells are skipped at once. May be read from any thread.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker {

// Optical depth beyond which no light is left: e^-40 is 4e-18.
inline constexpr float kOpaqueDepth = 40.0f;

class DensityField {
 public:
  // `density` is in m^-1, finite and not negative, with x fastest. `group_from_grid` is affine and maps voxel
  // coordinates.
  DensityField(const glm::uvec3& size, std::span<const float> density, const glm::mat4& group_from_grid);

  const glm::uvec3& size() const { return size_; }
  const glm::mat4& groupFromGrid() const { return group_from_grid_; }
  glm::vec3 gridFromGroup(const glm::vec3& p) const {
    return glm::vec3(grid_from_group_ * glm::vec4(p, 1.0f));
  }

  // Returns the density at a place of the grid, m^-1.
  float atGrid(const glm::vec3& grid) const;

  // Returns the optical depth along the unit `direction` from `origin`, both in the group's frame, over t_max
  // metres. Stops at kOpaqueDepth or a little more.
  float opticalDepth(const glm::vec3& origin, const glm::vec3& direction, float t_max) const;

  // Calls visit(begin, end, depth) for stretches of the ray, in ascending order: their ends in metres, at
  // most longest(begin) apart, and their optical depth, which is above 0. The ray is empty between them. Ends
  // when visit returns false.
  template <typename Longest, typename Visit>
  void march(const glm::vec3& origin, const glm::vec3& direction, float t_max, const Longest& longest,
             const Visit& visit) const;

 private:
  static constexpr int kBlock = 8;

  // A LatticeRay is a ray in lattice coordinates: voxel (i, j, k) of the grid is at (i + 1, j + 1, k + 1),
  // and around the grid a layer repeats the outermost voxels.
  struct LatticeRay {
    glm::vec3 origin, direction, inverse;
    glm::vec3 at(float t) const { return origin + t * direction; }
  };
  // A Walk steps through the unit cells (scaled by `side`) that a ray crosses.
  struct Walk {
    glm::ivec3 cell, step;
    glm::vec3 next, delta;  // distance at which the ray leaves the cell along each axis; from cell to cell
    Walk(const LatticeRay& ray, float t, float side, const glm::ivec3& low, const glm::ivec3& high);
    int axis() const { return next.x <= next.y ? (next.x <= next.z ? 0 : 2) : (next.y <= next.z ? 1 : 2); }
  };

  bool clip(const LatticeRay& ray, float& begin, float& end) const;
  std::size_t block(const glm::ivec3& b) const {
    return static_cast<std::size_t>(b.x + blocks_.x * (b.y + blocks_.y * b.z));
  }

  static constexpr std::size_t kBrick = (kBlock + 1) * (kBlock + 1) * (kBlock + 1);
  const float* brickAt(const glm::ivec3& b) const {
    return &bricks_[static_cast<std::size_t>(brick_of_[block(b)]) * kBrick];
  }

  struct Corners {
    float v[8];  // x fastest
    bool empty() const { return v[0] + v[1] + v[2] + v[3] + v[4] + v[5] + v[6] + v[7] == 0.0f; }
    float at(const glm::vec3& f) const {
      const float a = v[0] + f.x * (v[1] - v[0]), b = v[2] + f.x * (v[3] - v[2]);
      const float c = v[4] + f.x * (v[5] - v[4]), d = v[6] + f.x * (v[7] - v[6]);
      const float ab = a + f.y * (b - a), cd = c + f.y * (d - c);
      return ab + f.z * (cd - ab);
    }
  };
  // `inside` is the cell, relative to its block's first.
  Corners corners(const float* brick, const glm::ivec3& inside) const;

  template <typename Longest, typename Visit>
  bool marchBlock(const LatticeRay& ray, const glm::ivec3& block, float begin, float end,
                  const Longest& longest, const Visit& visit) const;

  glm::uvec3 size_;
  glm::mat4 group_from_grid_, grid_from_group_;
  glm::ivec3 points_, blocks_;  // size of the lattice; there is one cell less along each axis
  // For each block that is not empty, this has the 9 x 9 x 9 points of its cells side by side, since rays
  // stay in a block for a while.
  std::vector<float> bricks_;
  std::vector<std::int32_t> brick_of_;  // one per block; -1: empty
};

inline DensityField::Walk::Walk(const LatticeRay& ray, float t, float side, const glm::ivec3& low,
                                const glm::ivec3& high)
    : cell(glm::clamp(glm::ivec3(glm::floor(ray.at(t) / side)), low, high)) {
  for (int axis = 0; axis < 3; ++axis) {
    const bool up = ray.direction[axis] > 0.0f;
    step[axis] = up ? 1 : -1;
    const float plane = static_cast<float>(cell[axis] + (up ? 1 : 0)) * side;
    const bool still = ray.direction[axis] == 0.0f;
    next[axis] =
        still ? std::numeric_limits<float>::infinity() : (plane - ray.origin[axis]) * ray.inverse[axis];
    delta[axis] = still ? std::numeric_limits<float>::infinity() : std::abs(side * ray.inverse[axis]);
  }
}

inline DensityField::Corners DensityField::corners(const float* brick, const glm::ivec3& inside) const {
  constexpr int kRow = kBlock + 1, kSlice = kRow * kRow;
  const float* p = brick + inside.x + kRow * inside.y + kSlice * inside.z;
  return {
      {p[0], p[1], p[kRow], p[kRow + 1], p[kSlice], p[kSlice + 1], p[kSlice + kRow], p[kSlice + kRow + 1]}};
}

template <typename Longest, typename Visit>
bool DensityField::marchBlock(const LatticeRay& ray, const glm::ivec3& block_at, float begin, float end,
                              const Longest& longest, const Visit& visit) const {
  const glm::ivec3 low = block_at * kBlock, high = glm::min(low + (kBlock - 1), points_ - 2);
  Walk walk(ray, begin, 1.0f, low, high);
  const float* const brick = brickAt(block_at);
  for (float t = begin; t < end;) {
    const int axis = walk.axis();
    const glm::ivec3 cell = walk.cell;
    float leave = walk.next[axis];
    walk.cell[axis] += walk.step[axis];
    walk.next[axis] += walk.delta[axis];
    // The last cell takes what rounding leaves of the ray.
    if (leave >= end || walk.cell[axis] < low[axis] || walk.cell[axis] > high[axis]) leave = end;
    if (leave <= t) continue;
    if (const Corners values = corners(brick, cell - low); !values.empty()) {
      // Rounding may put a place a hair outside its cell, where the interpolation simply continues.
      const glm::vec3 start = ray.origin - glm::vec3(cell);
      const auto density = [&](float at) { return values.at(start + at * ray.direction); };
      for (float from = t, first = density(t); from < leave;) {
        const float step = longest(from);
        const float to = leave - from > 1.001f * step ? from + step : leave;
        const float last = density(to);
        const float depth = (to - from) / 6.0f * (first + 4.0f * density(0.5f * (from + to)) + last);
        if (depth > 0.0f && !visit(from, to, depth)) return false;
        from = to, first = last;
      }
    }
    t = leave;
  }
  return true;
}

template <typename Longest, typename Visit>
void DensityField::march(const glm::vec3& origin, const glm::vec3& direction, float t_max,
                         const Longest& longest, const Visit& visit) const {
  LatticeRay ray{gridFromGroup(origin) + 0.5f, glm::vec3(grid_from_group_ * glm::vec4(direction, 0.0f)),
                 glm::vec3(0.0f)};
  ray.inverse = 1.0f / ray.direction;
  float begin = 0.0f, end = t_max;
  if (!clip(ray, begin, end)) return;
  Walk walk(ray, begin, float{kBlock}, glm::ivec3(0), blocks_ - 1);
  for (float t = begin; t < end;) {
    const int axis = walk.axis();
    const glm::ivec3 at = walk.cell;
    float leave = walk.next[axis];
    walk.cell[axis] += walk.step[axis];
    walk.next[axis] += walk.delta[axis];
    if (leave >= end || walk.cell[axis] < 0 || walk.cell[axis] >= blocks_[axis]) leave = end;
    if (leave <= t) continue;
    if (brick_of_[block(at)] >= 0 && !marchBlock(ray, at, t, leave, longest, visit)) return;
    t = leave;
  }
}

// The grid of a volume's transfer covers the same box as the density, coarser or finer. Samples are the
// voxels with density anywhere in the reach of their interpolation (one voxel to every side of their centre);
// other voxels hold nothing. Above the samples are coarser levels, each with half the resolution, for light
// that comes from afar: a node is the mean of the nodes below it, weighted by density.

class TransferGrid {
 public:
  TransferGrid(const DensityField& density, std::span<const float> values, const glm::uvec3& size);

  const glm::uvec3& size() const { return levels_.front().size; }
  // Returns the samples as voxels of the grid, with x fastest, ascending.
  const std::vector<std::uint32_t>& voxels() const { return voxels_; }
  std::size_t samples() const { return voxels_.size(); }
  // Counts the samples and the nodes of levels 1, 2, ... that follow them.
  std::size_t nodes() const { return nodes_; }
  int levels() const { return static_cast<int>(levels_.size()); }

  // Returns the centre of a sample in the group's frame.
  glm::vec3 place(std::size_t sample) const;
  // Returns voxel coordinates of the transfer grid.
  glm::dvec3 gridFromGroup(const glm::dvec3& p) const {
    return glm::dvec3(grid_from_group_ * glm::dvec4(p, 1.0));
  }
  glm::dvec3 gridDirection(const glm::dvec3& d) const {
    return glm::dvec3(grid_from_group_ * glm::dvec4(d, 0.0));
  }
  // Return the edge of a voxel in metres: the shortest one, and that of a cube of the same volume.
  float shortestEdge() const { return shortest_edge_; }
  float meanEdge() const { return mean_edge_; }

  // A Stencil is the linear interpolation at a place of the grid, at one level: nodes and weights that sum to
  // 1. Nodes without density below them are left out; there are 0 entries if none is near. In the half voxel
  // towards the faces of the grid it is constant, as in all readers, or with `beyond` it continues the line
  // through the outermost two nodes.
  struct Stencil {
    int count = 0;
    std::array<std::uint32_t, 8> node;
    std::array<double, 8> weight;
    glm::dvec3 fraction{0.0};  // position between the lower and the upper nodes, 0..1
  };
  Stencil stencil(const glm::dvec3& grid, int level, bool beyond = false) const;

  // Returns the neighbours of a node on the same level; -1: none.
  std::pair<std::int32_t, std::int32_t> neighbors(std::uint32_t node, int axis) const {
    return {neighbors_[node][static_cast<std::size_t>(2 * axis)],
            neighbors_[node][static_cast<std::size_t>(2 * axis + 1)]};
  }

  // Fills in the levels above the samples; `values` is [node][width].
  void raise(std::span<float> values, std::size_t width) const;

 private:
  struct Level {
    glm::uvec3 size;
    std::vector<std::int32_t> node;  // one per voxel; -1: none
  };
  struct Child {
    std::uint32_t parent, child;
    float weight;
  };
  void linkNeighbors();
  void addLevel(std::vector<double>& mass);

  std::vector<Level> levels_;
  std::vector<std::uint32_t> voxels_;
  std::vector<Child> children_;  // in ascending order of levels
  std::vector<std::array<std::int32_t, 6>> neighbors_;
  std::size_t nodes_ = 0;
  glm::dmat4 group_from_grid_, grid_from_group_;
  float shortest_edge_ = 0.0f, mean_edge_ = 0.0f;
};

}  // namespace lambent::baker
