// Clustered principal components (Sloan 2003): the vectors of a cell as clusters, each a mean and a few axes,
// with one quantized weight per sample and axis. Here stands the lossless half: what the numbers mean, and
// encoder and decoder of the payloads. Which clusters, axes and steps to take is decided in baker/compress.
//
// Order of samples: as in the cell. Order of codes: by cluster, samples of one cluster in the order of the
// cell (positionsOf). Clusters are numbered by falling number of axes, so the samples that plane j concerns
// are the first planeCounts()[j] positions, and every plane is dense. Byte tables: docs/format.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::bundle {

inline constexpr std::uint32_t kMappedOutputs = 9;
// More outputs than a normal map needs are all bands that a glossy surface reflects.
constexpr bool isGlossy(std::uint32_t outputs) {
  return outputs > kMappedOutputs;
}
// Bands of so many outputs, a square number.
constexpr std::uint32_t bandsOf(std::uint32_t outputs) {
  std::uint32_t bands = 0;
  while (bands * bands < outputs) ++bands;
  return bands;
}

// What a transfer vector holds. Two blocks: light that arrives without a bounce ("shadowed") and all light
// ("full", absent without bounces). A value is [block: shadowed channels, then full
// channels][output][column]. Or, for glossy surfaces, the visibility itself, from which direct light follows
// by the product of spherical harmonics (runtime/sh/gaunt.hpp); beside it the bounced light alone has a
// transfer of its own, with shadowed_channels 0.
struct TransferShape {
  std::uint32_t order = 5;              // bands of the environment, 0..8; 0: the group's lights alone
  std::uint32_t light_columns = 0;      // lights that belong to the group
  std::uint32_t shadowed_channels = 1;  // 1: the same for R, G and B; 3: RGB
  std::uint32_t full_channels = 0;      // 0, 1 or 3
  // 1: E/pi at the sample's normal. 9: transferred light in bands 0..2 (for normal maps), to be convolved
  // with A_l/pi at the pixel's normal. 16, 25 or 36: transferred light l' = M l in bands 0..3, 4 or 5, for
  // glossy surfaces.
  std::uint32_t outputs = 1;
  // Over 0: the vector is the visibility V in so many bands, order + bands of the outputs - 1: all that their
  // product with the light needs (literature: rank of a shadow-only matrix). One channel.
  std::uint32_t visibility_bands = 0;

  std::uint32_t columns() const { return order * order + light_columns; }
  std::uint32_t channels() const { return shadowed_channels + full_channels; }
  bool isVisibility() const { return visibility_bands > 0; }
  bool glossy() const { return isGlossy(outputs); }
  std::uint32_t size() const {
    return isVisibility() ? visibility_bands * visibility_bands : channels() * outputs * columns();
  }
  bool operator==(const TransferShape&) const = default;
};

struct AxisCode {
  float offset = 0.0f, scale = 0.0f;  // weight = offset + scale * code
};

struct Codebook {
  std::vector<std::uint32_t> axis_counts;  // one per cluster, never rising
  std::vector<AxisCode> axes;              // cluster by cluster
  std::vector<float> vectors;              // cluster by cluster: the mean, then the axes; shape.size() each

  std::size_t clusters() const { return axis_counts.size(); }
};

// A codebook as the baker makes it: vectors are few, small integers in coordinates of one basis that the
// clusters of the cell share, so that each costs a few bits per coordinate after entropy coding.
//   basis vector r, value i = value_scales[i] * basis_scales[r] * basis[r * size + i]
//   mean of cluster c       = mean_scale * sum_r means[r * clusters + c] * basis vector r
//   axis j of cluster c     = sum_r directions[j][r][c] * basis vector r
// where directions[j][r] has an entry for each cluster with an axis j, the first ones: axes of the same
// number need like precision, so numbers of like size lie together.
struct SharedCodebook {
  std::vector<std::uint32_t> axis_counts;
  std::vector<AxisCode> axes;
  std::vector<float> value_scales;
  std::vector<float> basis_scales;  // one per basis vector
  float mean_scale = 0.0f;
  std::vector<std::int32_t> basis, means, directions;  // magnitudes under kMaxCoordinate

  std::size_t clusters() const { return axis_counts.size(); }
};
inline constexpr std::int32_t kMaxCoordinate = 1 << 22;

Codebook expand(const SharedCodebook& codebook);

// Payload "codebook", in one of two forms: with vectors as binary16, or over a shared basis.
std::vector<std::byte> encodeCodebook(const Codebook& codebook);
std::vector<std::byte> encodeCodebook(const SharedCodebook& codebook);
// Errors name `subject`: sizes that do not add up, counts that rise or exceed shape.size(), values that are
// not finite or so large that decoded vectors would not be.
Result<Codebook> decodeCodebook(std::span<const std::byte> bytes, const TransferShape& shape,
                                std::uint32_t clusters, const std::string& subject);

// Payload "clusterIds": one id per sample of the cell; one byte each up to 256 clusters, else two.
std::vector<std::byte> encodeClusterIds(std::span<const std::uint32_t> cluster_of, std::uint32_t clusters);
Result<std::vector<std::uint32_t>> decodeClusterIds(std::span<const std::byte> bytes, std::uint32_t clusters,
                                                    std::uint32_t sample_count, const std::string& subject);

// The samples in the order of the codes: stable counting sort by cluster.
std::vector<std::uint32_t> positionsOf(std::span<const std::uint32_t> cluster_of, std::uint32_t clusters);

// How many positions each plane concerns, one entry per plane: the samples in clusters of more axes.
std::vector<std::uint32_t> planeCounts(const Codebook& codebook, std::span<const std::uint32_t> cluster_of);

// Payload "weightPlane": codes of plane j in the order of positionsOf, `bits` (8 or 16) each, as the
// difference of each code from the one before it in the same plane (neighbours are alike): modulo 2^bits to
// the range around 0, then 0, -1, 1, -2, ... as 0, 1, 2, 3, ..., little endian. 16-bit planes have all low
// bytes first, then all high bytes.
std::vector<std::byte> encodeWeightPlane(std::span<const std::uint32_t> codes, std::uint32_t bits);
Result<std::vector<std::uint32_t>> decodeWeightPlane(std::span<const std::byte> bytes, std::uint32_t bits,
                                                     std::uint32_t count, const std::string& subject);

// Transfer vectors of one cell, sample-major, shape.size() each; `planes` may be a prefix, each as long as
// planeCounts says. The CPU twin of what the diffuse effect decodes in its shader.
std::vector<float> decodeTransfer(const TransferShape& shape, const Codebook& codebook,
                                  std::span<const std::uint32_t> cluster_of,
                                  std::span<const std::vector<std::uint32_t>> planes);

}  // namespace lambent::bundle
