// The grid of a volume's transfer covers the same box as the density, coarser or finer. Samples are the
// voxels with density anywhere in the reach of their interpolation (one voxel to every side of their centre);
// other voxels hold nothing. Above the samples are coarser levels, each with half the resolution, for light
// that comes from afar: a node is the mean of the nodes below it, weighted by density.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "baker/effects/volume/density_field.hpp"

namespace lambent::baker {

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
