// Defines what transfer payloads are, and their lossless codecs. A payload belongs to samples of one domain
// (where they lie) and has one form (what their vectors hold). Its sizes follow from the form, the bands and
// the channels.
//
// Transfer is coded by clustered principal component analysis (CPCA, Sloan 2003). The transfer vectors of a
// cell are grouped into clusters; a cluster has a mean and a few axes, and a sample has one quantized weight
// per axis. baker/compress chooses clusters, axes and quantization steps.
//
// Samples keep the order of the cell. Codes are ordered by cluster, and within a cluster as in the cell
// (positionsOf). Clusters are numbered by falling number of axes, so plane j covers the first
// planeCounts()[j] positions without gaps. docs/format.md has the byte tables.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::transfer {

// Tells where the samples of a payload lie.
enum class Domain : std::uint8_t {
  Vertex,    // on surfaces; vertices take them by their rows
  Voxel,     // in a volume: mean radiance that arrives, of which the medium scatters its albedo
  GridPoint  // around a body: the change (M - I) l that the body makes to the light there
};

// Tells what transfer gives at a sample.
enum class Form : std::uint8_t {
  Vector,        // one number per channel: E/pi at the sample's normal, or mean radiance
  NormalMapped,  // light of bands 0..2, to be convolved with A_l/pi at the pixel's normal
  Visibility,    // visibility V, whose product with the light replaces a matrix
  Matrix         // l' = M l, transferred light in bands
};

inline constexpr std::uint32_t kMappedOutputs = 9;  // of Form::NormalMapped

// Returns the number of bands for a number of outputs, which is a square.
constexpr std::uint32_t bandsOf(std::uint32_t outputs) {
  std::uint32_t bands = 0;
  while (bands * bands < outputs) ++bands;
  return bands;
}

// Returns the form in which samples of a domain hold so many outputs. Visibility counts as the matrix that it
// stands for.
constexpr Form formOf(Domain domain, std::uint32_t outputs) {
  if (outputs == 1) return Form::Vector;
  return domain == Domain::Vertex && outputs == kMappedOutputs ? Form::NormalMapped : Form::Matrix;
}

// Returns whether samples are evaluated as matrices, output by output (runtime/evaluate). This is so
// for points around bodies, and for more bands than a diffuse receiver takes. Other samples are evaluated as
// vectors.
constexpr bool evaluatedAsMatrix(Domain domain, std::uint32_t outputs) {
  return domain == Domain::GridPoint || outputs > kMappedOutputs;
}

// Describes a transfer vector. Values are indexed [channel][output][column]. The channels are those of direct
// light ("shadowed") followed by those of direct and bounced light ("full", absent if the bake had no
// bounces). For glossy surfaces the vector can instead be the visibility, which gives direct light by the
// product of spherical harmonics (runtime/sh/gaunt.hpp); bounced light then has a second transfer with
// shadowed_channels 0.
struct TransferShape {
  std::uint32_t order = 5;              // bands of the environment, 0..8; 0 if only the group's lights count
  std::uint32_t light_columns = 0;      // number of lights that belong to the group
  std::uint32_t shadowed_channels = 1;  // 1 if R, G and B are equal, 3 for RGB, or 0
  std::uint32_t full_channels = 0;      // 0, 1 or 3
  // One output is E/pi at the sample's normal. Nine are transferred light in bands 0..2 for normal maps; it
  // is convolved with A_l/pi at the pixel's normal. Glossy surfaces have 16, 25 or 36, which are transferred
  // light l' = M l in 4, 5 or 6 bands.
  std::uint32_t outputs = 1;
  // If above 0, the vector is the visibility V in this many bands and one channel. The product with the light
  // needs order + (bands of the outputs) - 1 bands.
  std::uint32_t visibility_bands = 0;

  std::uint32_t columns() const { return order * order + light_columns; }
  std::uint32_t channels() const { return shadowed_channels + full_channels; }
  bool isVisibility() const { return visibility_bands > 0; }
  // Returns whether it has more bands than a diffuse receiver takes, as glossy surfaces have.
  bool beyondDiffuse() const { return outputs > kMappedOutputs; }
  Form form(Domain domain) const { return isVisibility() ? Form::Visibility : formOf(domain, outputs); }
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

// Runs body(begin, end) over ranges of [0, count), in any order.
using RunRanges = std::function<void(std::size_t count,
                                     const std::function<void(std::size_t begin, std::size_t end)>& body)>;

// Returns the transfer vectors of all samples of a cell, shape.size() values each. `planes` may hold only the
// first planes of the cell; their lengths are those of planeCounts. This is the CPU twin of the shader
// decoder.
std::vector<float> decodeTransfer(
    const TransferShape& shape, const Codebook& codebook, std::span<const std::uint32_t> cluster_of,
    std::span<const std::vector<std::uint32_t>> planes,
    const RunRanges& run = [](std::size_t count, const auto& body) { body(0, count); });

// Weights that blend: those of the samples from which a vertex takes its light, and those of the light probes
// from which a sample takes its own.

// Encodes and decodes the rows of vertices, which say from which samples each vertex takes its light, and how
// much from each. docs/format.md has the byte tables.

// Transfer at vertex v is the weighted sum of samples over entries [offsets[v], offsets[v+1]). The weights of
// a vertex sum to 1.
struct VertexWeights {
  std::vector<std::uint32_t> offsets;  // vertex_count + 1 entries, starting at 0 and never falling
  std::vector<std::uint32_t> samples;  // samples of the group
  std::vector<float> weights;          // stored as unorm16, 0..1
};

std::vector<std::byte> encodeRows(const VertexWeights& rows);
// Fails, naming `subject`, if sizes do not add up or a sample is not below sample_count.
Result<VertexWeights> decodeRows(std::span<const std::byte> bytes, std::uint32_t vertex_count,
                                 std::uint32_t sample_count, const std::string& subject);

// The payload LightWeights says how each sample of a cell blends its light probes. The incident light at a
// sample is Σ_k weight_k / 255 x (light at probe k) over up to four probes of the cell's list (Sloan, Kautz
// and Snyder 2002, section 6: several probes, blended per vertex).
inline constexpr std::size_t kLightsPerSample = 4;

struct LightWeights {
  std::array<std::uint8_t, kLightsPerSample> light{};   // positions in Cell::light_probes
  std::array<std::uint8_t, kLightsPerSample> weight{};  // falling; they sum to 255
  bool operator==(const LightWeights&) const = default;
};

// These weights take all light from the cell's first probe.
inline constexpr LightWeights kOneLight{{}, {255}};

// The payload is eight runs of one byte per sample: light 0, ..., light 3, weight 0, ..., weight 3. Decoding
// fails, naming `subject`, if the length is wrong, a probe is not in the cell's list of `light_count` probes,
// or weights do not sum to 255.
std::vector<std::byte> encodeLightWeights(std::span<const LightWeights> samples);
Result<std::vector<LightWeights>> decodeLightWeights(std::span<const std::byte> bytes,
                                                     std::size_t sample_count, std::size_t light_count,
                                                     const std::string& subject);

}  // namespace lambent::transfer
