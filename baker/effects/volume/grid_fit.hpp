// The values at the voxels of a transfer grid with which linear interpolation comes closest to what is wanted
// at many places of the medium, by weighted least squares:
//   minimise  sum_p w_p |sum_q phi_q(p) c_q - v_p|²  +  h sum_q |c_q - s_q|²,
// phi_q the interpolation's share of voxel q, s what the samples have to begin with: what no place of weight
// is near stays as it is. Constants go through exactly, for shares sum to 1. One thread adds; sums run in the
// order of that.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/effects/volume/transfer_grid.hpp"

namespace lambent::baker {

class GridFit {
 public:
  // width: values at a place. samples: [sample][width], s above. Both outlive this.
  GridFit(const TransferGrid& grid, std::size_t width, std::span<const float> samples);

  // place: group frame. weight: not negative.
  void add(const glm::vec3& place, double weight, std::span<const float> wanted);

  // What is to be added to the samples, [sample][width].
  std::vector<float> solve() const;

 private:
  // Voxels that share in places with a voxel: within one of it each way.
  static constexpr std::size_t kAround = 27;
  static std::size_t slotOf(const glm::ivec3& step) {
    return static_cast<std::size_t>(step.x + 1 + 3 * (step.y + 1 + 3 * (step.z + 1)));
  }
  glm::ivec3 voxelOf(std::size_t sample) const;
  void solveColumn(std::size_t column, double hold, std::vector<float>& out) const;

  const TransferGrid& grid_;
  std::size_t width_;
  std::span<const float> samples_;
  std::vector<std::array<double, kAround>> matrix_;          // sum of w phi_q phi_r, r by its step from q
  std::vector<std::array<std::uint32_t, kAround>> columns_;  // that r; q itself where there is none
  std::vector<double> right_;                                // sum of w phi_q (v - what the samples give)
  std::vector<float> lacks_;
};

}  // namespace lambent::baker
