// Codes the transfer vectors of one cell by clustered principal components (Sloan, Hall, Hart, Snyder 2003)
// with quantized weights, so that the relative RMS error of shaded radiance over real lights stays under a
// bound:
//   sqrt( sum_s sum_i W_i (t_s,i - t'_s,i)² / sum_s sum_i W_i t_s,i² ) <= bound
// over each block by itself: full light, which is shown, and shadowed light. W_i: the band power of light
// (light_weights.hpp) for columns of the environment; for lights of the group what makes each count as much
// as the whole environment; for outputs of normal maps times (A_l/pi)² of the output's band, for those of
// glossy surfaces times the power of a lobe in it. Of visibility, coefficient k makes errors of power Σ_ij
// lobe_i light_j Γ_ijk² in what is reflected. The number of clusters and of axes in each is what codes to the
// fewest bytes (codebook, ids and weights after entropy coding). Planes come by falling variance: any prefix
// renders. Deterministic, for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/cache/cached_ranges.hpp"
#include "baker/compress/light_weights.hpp"
#include "runtime/bundle/codebook.hpp"

namespace lambent::baker {

struct CodedPlane {
  std::uint32_t bits = 8;            // 8 or 16
  float variance = 0.0f;             // share of the cell's weighted variance about its mean
  std::vector<std::uint32_t> codes;  // in the order of bundle::positionsOf
};

struct CodedTransfer {
  bundle::TransferShape shape;
  bundle::SharedCodebook codebook;
  std::vector<std::uint32_t> cluster_of;  // per sample
  std::vector<CodedPlane> planes;         // by falling variance
  float error = 0.0f;                     // measured on the decoded vectors
};

// Light between sharp metals has no leading components, and all of it costs more than the rest together, of
// bytes and of time when light changes: the bound is missed rather than take more than these to keep it. But
// once so few leave out much, many of them told roughly say more, byte for byte, than few told exactly: see
// CodingSettings::loose_bound.
inline constexpr std::uint32_t kUsualComponents = 128, kAllComponents = 1u << 16;

struct CodingSettings {
  float bound = 0.005f;        // > 0
  std::uint32_t clusters = 0;  // 0: whatever codes to the fewest bytes
  int axes = -1;               // of every cluster, whatever the bound; -1: as many as it takes
  std::uint32_t most_components = kUsualComponents;  // of long vectors (matrices)
  // Over `bound`: what is kept, with all components, where most_components leave out more than this.
  float loose_bound = 0.0f;
  // Of means and axes as they lie on the GPU, where all of a cell is in one page of 128 MiB (gpu::Arena):
  // clusters are as few as that takes, and the bound is missed where one alone is too large.
  std::size_t most_expanded_bytes = std::size_t{64} << 20;
  // Over 0: what errors are relative to, in place of the vectors' own energy (transferEnergy): visibility and
  // bounced light are shown together.
  double shown_energy = 0.0;
  // Of glossy transfer: how much an error in an output of each band shows.
  BandPower kernel_power = kLobePower;
};

// Σ_s Σ_i W_i t_s,i² over red, green and blue.
double transferEnergy(std::span<const float> vectors, const bundle::TransferShape& shape,
                      const BandPower& kernel_power = kLobePower);

// vectors: `count` times shape.size() values, count > 0; all finite. Stops early, with an unusable result,
// when asked to. keep: of all of the above; how far the work has come is kept there when a checkpoint is due
// and when it is stopped, and the next call goes on from there. It stays until CodingCheckpoint::drop
// (coding_state.hpp); kept_transfer.hpp does all that.
CodedTransfer codeTransfer(std::span<const float> vectors, std::size_t count,
                           const bundle::TransferShape& shape, const CodingSettings& settings,
                           const std::stop_token& stop = {}, const Keep& keep = {});

// The error that codeTransfer bounds: of the worse of the two blocks.
double radianceError(std::span<const float> truth, std::span<const float> coded,
                     const bundle::TransferShape& shape, double shown_energy = 0.0,
                     const BandPower& kernel_power = kLobePower);

}  // namespace lambent::baker
