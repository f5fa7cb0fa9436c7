// Gives isotropic.cpp and phased.cpp the light that reaches the samples of a volume unscattered, and the solver
// that adds all scatterings to it.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include "baker/effects/volume/grids.hpp"
#include "baker/effects/volume/volume.hpp"
#include "baker/effects/volume/volume_rays.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

inline constexpr std::size_t kSamplesPerLight = 16;  // samples in a range of lightIn()
inline constexpr std::size_t kSamplesPerChunk = 64;  // samples whose rays are stored together

// FirstLights hold the light that reaches samples unscattered, and how much the medium takes.
struct FirstLights {
  // [sample][columns of the table]. With an anisotropic phase function it is the transmittance tau(s) by
  // direction, through the medium and past the surfaces: with incident light l, the coefficients
  //   L_i = sum_jk Gamma_ijk tau_k l_j
  // arrive. This is exact with tau in order + bands - 1 bands (literature 1.9).
  std::vector<float> transfer;
  std::vector<float> clear;        // [sample][outputs], as in FirstLight::look; empty with one output
  std::vector<double> met, out;    // [sample], as in Arrival
  std::size_t samples_traced = 0;  // in this run; the others were found in the cache
};

// Returns nothing if stopped.
std::optional<FirstLights> lightIn(const VolumeScene& scene, const SphereTable& table, std::size_t outputs,
                                   const BakeContext& context);

// Columns are handled in blocks of this size, with those of a sample side by side: [sample][kBlockColumns].
inline constexpr std::size_t kBlockColumns = 32;
inline constexpr int kMostKeptVectors = 24;

// The system T = T0 + w K T for a block of columns, [row][kBlockColumns]; a row is an output of a sample. It
// is scaled by the diagonal: the light that a row sends to itself is taken out of the iteration, so that
// thick media converge too.
struct ScatteringSystem {
  struct Row {
    double scale, rest, stays;
  };
  // Computes y = K x without a part on the diagonal: K x = y + stays x, and without k_pp it is y + rest x.
  // Returns false if stopped.
  std::function<bool(std::span<const float> x, std::span<float> y)> apply;
  // Returns the rows for an albedo w, where `scale` is 1 / (1 - w k_pp).
  std::function<std::vector<Row>(double albedo)> rows;
  int kept_vectors;  // basis vectors that the solver keeps, at most kMostKeptVectors
};

// Adds scattered light to the first light of a volume: solves for each channel and each block of columns. The
// first light is the first block of each of out.vectors, and the channels follow it. Returns false if
// stopped.
bool scatterLight(const ScatteringSystem& system, const VolumeSettings& settings, VolumeTransfer& out,
                  const BakeContext& context);

// Bake the vectors of `out`, whose grid, order, bands and channels are set: the mean radiance that arrives at
// samples, or, for an anisotropic phase function, the radiance in bands. Return false if stopped.
bool bakeIsotropicTransfer(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                           VolumeTransfer& out, const BakeContext& context);
bool bakePhasedTransfer(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                        VolumeTransfer& out, const BakeContext& context);
// Removes what bakeIsotropicTransfer() kept of light within voxels.
void dropWithinVoxels(const BakeContext& context, const DensityField& density, const TransferGrid& grid);

// A GridFit fits the values at the voxels of a transfer grid so that linear interpolation comes closest to
// given values at many places of the medium, by weighted least squares:
//   minimise  sum_p w_p |sum_q phi_q(p) c_q - v_p|²  +  h sum_q |c_q - s_q|²,
// where phi_q is the interpolation weight of voxel q, and s are the samples before the fit, so voxels without
// a weighted place nearby keep their values. Constants are reproduced exactly, since the weights sum to 1.
// One thread adds places; sums run in the order in which they are added.
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
  const TransferGrid& grid_;
  std::size_t width_;
  std::span<const float> samples_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix_;  // sum of w phi_q phi_r
  Eigen::MatrixXd right_;  // sum of w phi_q (v - interpolated samples); a column for each value
};

}  // namespace lambent::baker
