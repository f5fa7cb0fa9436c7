// The room baker/compress owns lossy coding: this file codes the transfer vectors of one cell, and
// draco_encode.hpp codes meshes. It follows clustered principal components (Sloan, Hall, Hart, Snyder 2003)
// with quantized weights, and keeps the relative RMS error of shaded radiance over real lights under a bound:
//   sqrt( sum_s G_s sum_i W_i (t_s,i - t'_s,i)² / sum_s sum_i W_i t_s,i² ) <= bound
// G_s makes errors in dark samples count more, since eyes adapt, and those in samples that matter to pictures
// (sampleImportance in cpca_clusters.hpp); each cluster has steps of its own by it. The bound holds for each
// block (shadowed light, and full light, which is shown) by itself. W_i is the band power of light
// (kBandPower) for columns of the environment; columns of the group's lights are weighted so that each
// light counts as much as the whole environment. W_i is multiplied by (A_l/pi)² of the output's band for
// normal maps, and by the power of a lobe in that band for glossy surfaces. For visibility, an error in
// coefficient k changes what is reflected by a power of Σ_ij lobe_i light_j Γ_ijk².
//
// The number of clusters and of axes in each is whatever codes to the fewest bytes (codebook, ids and weights
// after entropy coding). Planes come by falling variance, so any prefix renders. Coding works on several
// threads; its result is the same for any number of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "runtime/transfer/codebook.hpp"

namespace lambent::baker {

// Says how much light real scenes have per coefficient of each band, relative to band 0. Error bounds are
// stated in shaded radiance over such lights and not in raw coefficients, since an error in a band that
// carries little light matters little. This is the mean over lights of (sum over m and RGB of l_lm²) /
// (2l+1), each light divided by its own band 0. If lights are rotated at random, the covariance of their
// vectors is diagonal with these entries, so they are all that the mean error needs. docs/design/reference.md
// names the lights.
inline constexpr std::array<double, 8> kBandPower = {1.0,    0.5085, 0.3297, 0.2374,
                                                     0.1984, 0.1678, 0.1428, 0.1173};

// BandPower is the power of a glossy kernel per coefficient of each band, relative to band 0. It weights
// errors of transferred light. kLobePower is that of GGX of roughness 0.3, the sharpest of which order 5
// carries a fair part (mean over views 11 to 77 degrees from the normal); a bake uses the power of its own
// materials.
using BandPower = std::array<double, 6>;
inline constexpr BandPower kLobePower = {1.0, 0.910, 0.795, 0.682, 0.579, 0.486};

struct CodedPlane {
  std::uint32_t bits = 8;            // 8 or 16
  float variance = 0.0f;             // share of the cell's weighted variance about its mean
  std::vector<std::uint32_t> codes;  // in the order of transfer::positionsOf
};

struct CodedTransfer {
  transfer::TransferShape shape;
  transfer::SharedCodebook codebook;
  std::vector<std::uint32_t> cluster_of;  // per sample
  std::vector<CodedPlane> planes;         // by falling variance
  float error = 0.0f;                     // measured on the decoded vectors
};

// These limit the components of transfer matrices. Light between sharp metals has no leading components, and
// keeping all of it costs more bytes and more time per change of light than everything else together; so the
// bound is missed rather than exceed kUsualComponents. If they leave out too much, however, many components
// coded roughly say more per byte than few coded exactly (CodingSettings::loose_bound).
inline constexpr std::uint32_t kUsualComponents = 128, kAllComponents = 1u << 16;

struct CodingSettings {
  float bound = 0.005f;                              // > 0
  std::uint32_t clusters = 0;                        // 0 means whatever codes to the fewest bytes
  std::uint32_t most_components = kUsualComponents;  // for long vectors (matrices)
  // If this is above `bound`, and most_components leave out more than this, all components are used and this
  // bound is kept instead.
  float loose_bound = 0.0f;
  // Limit for decoded means and axes, since on the GPU all of a cell lies in one page of 128 MiB
  // (gpu::Arena). It limits the number of clusters; if even a single cluster is too large, the bound is
  // missed.
  std::size_t most_expanded_bytes = std::size_t{64} << 20;
  // If above 0, errors are relative to this instead of the vectors' own energy (transferEnergy), for
  // visibility and bounced light, which are shown together.
  double shown_energy = 0.0;
  // For glossy transfer, this says how much an error in an output of each band shows.
  BandPower kernel_power = kLobePower;
  // How much each sample matters to pictures, relative to others; empty: all alike. Above 0.
  std::span<const float> weights = {};
};

// Returns Σ_s Σ_i W_i t_s,i² over red, green and blue.
double transferEnergy(std::span<const float> vectors, const transfer::TransferShape& shape,
                      const BandPower& kernel_power = kLobePower);

// vectors: `count` times shape.size() values, count > 0; all finite. The result is unusable if stopped.
CodedTransfer codeTransfer(std::span<const float> vectors, std::size_t count,
                           const transfer::TransferShape& shape, const CodingSettings& settings,
                           std::stop_token stop = {});

// Returns the vectors that the codes hold, coded.shape.size() values per sample.
std::vector<float> decodeTransfer(const CodedTransfer& coded);

// Returns the error that codeTransfer bounds: that of the worse of the two blocks.
double radianceError(std::span<const float> truth, std::span<const float> coded,
                     const transfer::TransferShape& shape, double shown_energy = 0.0,
                     const BandPower& kernel_power = kLobePower, std::span<const float> weights = {});

}  // namespace lambent::baker
