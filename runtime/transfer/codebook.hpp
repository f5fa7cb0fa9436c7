// Transfer is coded by clustered principal component analysis (CPCA, Sloan 2003). The transfer vectors of a
// cell are grouped into clusters; a cluster has a mean and a few axes, and a sample has one quantized weight
// per axis. This header defines the numbers and their lossless payloads. baker/compress chooses clusters,
// axes and quantization steps.
//
// Samples keep the order of the cell. Codes are ordered by cluster, and within a cluster as in the cell
// (positionsOf). Clusters are numbered by falling number of axes, so plane j covers the first
// planeCounts()[j] positions without gaps. docs/format.md has the byte tables.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/transfer/layout.hpp"

namespace lambent::transfer {

struct AxisCode {
  float offset = 0.0f, scale = 0.0f;  // weight = offset + scale * code
};

struct Codebook {
  std::vector<std::uint32_t> axis_counts;  // one per cluster, never rising
  std::vector<AxisCode> axes;              // cluster by cluster
  std::vector<float> vectors;              // per cluster the mean, then the axes; shape.size() values each

  std::size_t clusters() const { return axis_counts.size(); }
};

// A codebook as the baker makes it. The clusters of the cell share one basis, and vectors have small integer
// coordinates in it, which cost a few bits each after entropy coding.
//   basis vector r, value i = value_scales[i] * basis_scales[r] * basis[r * size + i]
//   mean of cluster c       = mean_scale * sum_r means[r * clusters + c] * basis vector r
//   axis j of cluster c     = sum_r directions[j][r][c] * basis vector r
// Only the first clusters have an axis j, and directions[j][r] has one entry for each of them. Axes of the
// same number need similar precision, so this order keeps numbers of similar size together.
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

// Encode the payload "codebook", with vectors either as binary16 or over a shared basis.
std::vector<std::byte> encodeCodebook(const Codebook& codebook);
std::vector<std::byte> encodeCodebook(const SharedCodebook& codebook);
// Fails, naming `subject`, if sizes do not add up, axis counts rise or exceed shape.size(), or values are so
// large that decoded vectors would not be finite.
Result<Codebook> decodeCodebook(std::span<const std::byte> bytes, const TransferShape& shape,
                                std::uint32_t clusters, const std::string& subject);

// The payload "clusterIds" has one id per sample of the cell, in one byte for up to 256 clusters, else in
// two.
std::vector<std::byte> encodeClusterIds(std::span<const std::uint32_t> cluster_of, std::uint32_t clusters);
Result<std::vector<std::uint32_t>> decodeClusterIds(std::span<const std::byte> bytes, std::uint32_t clusters,
                                                    std::uint32_t sample_count, const std::string& subject);

// Returns the samples in the order of the codes, by a stable sort by cluster.
std::vector<std::uint32_t> positionsOf(std::span<const std::uint32_t> cluster_of, std::uint32_t clusters);

// Returns the number of codes in each plane: plane j has one for each sample whose cluster has an axis j.
std::vector<std::uint32_t> planeCounts(const Codebook& codebook, std::span<const std::uint32_t> cluster_of);

// The payload "weightPlane" has the codes of plane j in the order of positionsOf, with 8 or 16 `bits` each.
// Each code is stored as its difference from the code before it, because neighbours are similar. The
// difference is reduced modulo 2^bits to the range around 0 and zigzag coded (0, -1, 1, -2, ... as 0, 1, 2,
// 3, ...). A 16-bit plane has all low bytes first, then all high bytes.
std::vector<std::byte> encodeWeightPlane(std::span<const std::uint32_t> codes, std::uint32_t bits);
Result<std::vector<std::uint32_t>> decodeWeightPlane(std::span<const std::byte> bytes, std::uint32_t bits,
                                                     std::uint32_t count, const std::string& subject);

// Decodes the samples of a cell. `planes` may hold only the first planes of the cell; their lengths are those
// of planeCounts. This is the CPU twin of the shader decoder. What it is given must outlive it.
class TransferDecoder {
 public:
  TransferDecoder(const TransferShape& shape, const Codebook& codebook,
                  std::span<const std::uint32_t> cluster_of,
                  std::span<const std::vector<std::uint32_t>> planes);
  // Decodes those samples whose codes lie at positions [begin, end), and writes shape.size() values of each
  // to its place in `out`, which has room for all samples.
  void decode(std::size_t begin, std::size_t end, std::span<float> out) const;

 private:
  std::size_t size_;
  const Codebook& codebook_;
  std::span<const std::uint32_t> cluster_of_;
  std::span<const std::vector<std::uint32_t>> planes_;
  std::vector<std::size_t> first_axis_;   // of each cluster
  std::vector<std::uint32_t> sample_at_;  // of each position
};

// Returns the transfer vectors of all samples.
std::vector<float> decodeTransfer(const TransferShape& shape, const Codebook& codebook,
                                  std::span<const std::uint32_t> cluster_of,
                                  std::span<const std::vector<std::uint32_t>> planes);

}  // namespace lambent::transfer
