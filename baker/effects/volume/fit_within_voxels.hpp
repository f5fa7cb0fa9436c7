// Fits the values at the voxels of a transfer grid so that linear interpolation comes closest to given values
// at many places of the medium, by weighted least squares:
//   minimise  sum_p w_p |sum_q phi_q(p) c_q - v_p|²  +  h sum_q |c_q - s_q|²,
// where phi_q is the interpolation weight of voxel q, and s are the samples before the fit, so voxels without
// a weighted place nearby keep their values. Constants are reproduced exactly, since the weights sum to 1.
// One thread adds places; sums run in the order in which they are added.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/effects/volume/grids.hpp"
#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/effects/volume/volume.hpp"
#include "baker/effects/volume/volume_rays.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

class GridFit {
 public:
  // `width` is the number of values at a place; `samples` is [sample][width], s above. Grid and samples must
  // outlive this.
  GridFit(const TransferGrid& grid, std::size_t width, std::span<const float> samples);

  // `place` is in the group's frame; `weight` must not be negative.
  void add(const glm::vec3& place, double weight, std::span<const float> wanted);

  // Returns the correction to add to the samples, [sample][width].
  std::vector<float> solve() const;

 private:
  // A voxel shares places with those at most one step away along each axis.
  static constexpr std::size_t kAround = 27;
  static std::size_t slotOf(const glm::ivec3& step) {
    return static_cast<std::size_t>(step.x + 1 + 3 * (step.y + 1 + 3 * (step.z + 1)));
  }
  glm::ivec3 voxelOf(std::size_t sample) const;
  void solveColumn(std::size_t column, double hold, std::vector<float>& out) const;

  const TransferGrid& grid_;
  std::size_t width_;
  std::span<const float> samples_;
  std::vector<std::array<double, kAround>> matrix_;          // sum of w phi_q phi_r; r by its step from q
  std::vector<std::array<std::uint32_t, kAround>> columns_;  // sample of that r, or q itself if there is none
  std::vector<double> right_;                                // sum of w phi_q (v - interpolated samples)
  std::vector<float> lacks_;
};

// Fits a transfer grid that is too coarse for its medium. Where a free path is shorter than a voxel, light
// changes within the voxel, most of all at the border of the medium, which is the part that one sees; voxel
// centres miss that, and pictures come out too dark. So light is computed at eight more places per voxel,
// with an eighth of the rays each, rotated from place to place: light that comes in from outside, and one
// scattering of the solver's result. Samples then become the values that interpolate best to it, weighted by
// how much of it leaves the medium: density times the mean transmittance to the outside
// (fit_within_voxels.hpp).

// Changes the vectors of `out`, which must have one output. `rows` is null if there is only single
// scattering. Voxels whose optical depth is at most 0.25 at all of their places are left out. Returns false
// if stopped.
bool fitWithinVoxels(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                     const ScatterRows* rows, VolumeTransfer& out, const BakeContext& context);
// Removes what fitWithinVoxels() kept.
void dropWithinVoxels(const BakeContext& context, const DensityField& density, const TransferGrid& grid);

}  // namespace lambent::baker
