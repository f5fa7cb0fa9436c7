#include "baker/effects/glossy/glossy_bounces.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "baker/compress/light_weights.hpp"
#include "baker/effects/glossy/traced_points.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/direction_table.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kMostOutputs = sh::coefficientCount(sh::kMaxFactoredOrder);
// Number of hits whose radiance is added to a matrix at once.
constexpr std::size_t kBlock = 8;
// Uniform light of radiance 1 has sqrt(4 pi) as its coefficient 0 and no others.
constexpr float kUniform = 3.54490770f;

// The rays of a row share the exit radiance of one of their hits; the larger the share of all light that a
// pass carries, the shorter its rows. V needs many rays for its edges, while exit radiance at a glossy point
// costs reading a matrix. Each hit keeps its own weight, so a white furnace stays white in every output.
// Noise is proportional to share x rays^0.75, so every pass may have rows of 1 / share rays; kCaution
// shortens them, since late passes add up in white rooms. Every row has a few rays: pictures by 128
// or 256 exit radiances show no more noise (docs/design/glossy.md).
constexpr std::uint32_t kMostTogether = 32;
constexpr double kCaution = 64.0;       // rows have 2 rays up to a share of 1.6 %, 4 up to 0.8 %
constexpr std::size_t kLeastRows = 64;  // rows over the hemisphere
constexpr std::size_t kManyRays = 1024;

std::uint32_t raysTogether(double share, std::size_t rays) {
  std::uint32_t together = rays >= kManyRays ? 4 : 2;
  while (together < kMostTogether && kCaution * together * share <= 1.0 &&
         rays / (2 * together) >= kLeastRows)
    together *= 2;
  return together;
}

// Computes for each of `Kernels` kernels of `outputs` values, stored one after the other:
//   out[n * out_stride + i] += weight Σ_k kernel_n[k] matrix[k * Columns + i].
// Vectors are written by hand, since the compiler leaves the sums in memory.
template <std::size_t Columns, std::size_t Kernels>
void contract(const float* kernels, std::size_t outputs, const float* matrix, float weight, float* out,
              std::size_t out_stride) {
  typedef float Eight __attribute__((vector_size(32)));
  constexpr std::size_t kWhole = Columns / 8, kRest = Columns % 8;
  Eight sums[Kernels][kWhole] = {};
  std::array<std::array<float, Kernels>, kRest> rest{};
  for (std::size_t k = 0; k < outputs; ++k, matrix += Columns) {
    for (std::size_t w = 0; w < kWhole; ++w) {
      Eight row;
      std::memcpy(&row, matrix + 8 * w, sizeof(row));
      for (std::size_t n = 0; n < Kernels; ++n) sums[n][w] += kernels[n * outputs + k] * row;
    }
    for (std::size_t i = 0; i < kRest; ++i)
      for (std::size_t n = 0; n < Kernels; ++n)
        rest[i][n] += kernels[n * outputs + k] * matrix[8 * kWhole + i];
  }
  for (std::size_t n = 0; n < Kernels; ++n, out += out_stride) {
    for (std::size_t w = 0; w < kWhole; ++w)
      for (std::size_t i = 0; i < 8; ++i) out[8 * w + i] += weight * sums[n][w][i];
    for (std::size_t i = 0; i < kRest; ++i) out[8 * kWhole + i] += weight * rest[i][n];
  }
}

struct MatrixView {
  const float* values;
  std::size_t outputs, columns;
};

template <std::size_t Kernels>
void contract(const float* kernels, const MatrixView& matrix, float weight, float* out,
              std::size_t out_stride) {
  const auto [values, outputs, columns] = matrix;
  switch (columns) {
    case 16:
      return contract<16, Kernels>(kernels, outputs, values, weight, out, out_stride);
    case 25:
      return contract<25, Kernels>(kernels, outputs, values, weight, out, out_stride);
    case 36:
      return contract<36, Kernels>(kernels, outputs, values, weight, out, out_stride);
    default:
      for (std::size_t n = 0; n < Kernels; ++n)
        for (std::size_t k = 0; k < outputs; ++k)
          for (std::size_t i = 0; i < columns; ++i)
            out[n * out_stride + i] += weight * kernels[n * outputs + k] * values[k * columns + i];
  }
}

}  // namespace

// A Walk is one thread's way through a range of samples.
class GlossyBounces::Walk {
 public:
  // Both arguments must outlive this.
  Walk(const GlossyPass& pass, const Bounce& bounce)
      : pass_(pass),
        bounce_(bounce),
        outputs_from_local_(glm::dmat3(1.0), pass.shape().order_out),
        exits_(kBlock * bounce.before.vectorSize()) {}

  // Gathers at sample `s` of the pass. Hits in a row of `together` rays (raysTogether) share the exit
  // radiance of one of them.
  void gather(std::size_t s, const StoredHits& stored, std::uint32_t together,
              const GlossyHemisphere& hemisphere, State& now) {
    const std::span<const GatherHit> hits = stored.of(s);
    const std::span<const MirroredLight> mirrored = stored.mirroredOf(s);
    if (hits.empty() && mirrored.empty()) return;
    const std::size_t sample = pass_.first() + s;
    const glm::vec3 normal = pass_.scene().samples.normals[sample];
    const ExitToSample exit(bounce_, hemisphere.table(), normal, sample);
    const std::size_t stride = bounce_.before.vectorSize(), even = hemisphere.evenOutputs();
    local_.assign(even * stride, 0.0f);
    std::fill(exits_.begin(), exits_.end(), 0.0f);
    std::size_t filled = 0;
    for (std::size_t first = 0, last = 0; first < hits.size(); first = last) {
      const std::uint32_t row = hits[first].ray / together;
      std::array<float, kMostOutputs> weights{};
      for (; last < hits.size() && hits[last].ray / together == row; ++last) {
        const float* own = hemisphere.row(hits[last].ray).data();
        for (std::size_t e = 0; e < even; ++e) weights[e] += own[e];
      }
      for (std::size_t e = 0; e < even; ++e) weights_[e][filled] = weights[e];
      // A golden-ratio sequence picks another hit in each row and each pass.
      const std::uint32_t dealt = (row + static_cast<std::uint32_t>(bounce_.number) * 5u) * 2654435769u;
      const auto pick = static_cast<std::size_t>(std::uint64_t{dealt} * (last - first) >> 32);
      exit.add(hits[first + pick], 1.0f, std::span(exits_).subspan(filled * stride, stride));
      if (++filled == kBlock) addBlock(even), filled = 0;
    }
    for (const MirroredLight& light : mirrored) {
      if (!exit.brings(light)) continue;
      for (std::size_t e = 0; e < even; ++e) weights_[e][filled] = hemisphere.row(light.hit.ray)[e];
      scratch_.resize(stride);
      exit.addMirrored(light, 1.0f, scratch_, std::span(exits_).subspan(filled * stride, stride));
      if (++filled == kBlock) addBlock(even), filled = 0;
    }
    if (filled > 0) {
      for (auto& of_output : weights_)
        std::fill(of_output.begin() + static_cast<std::ptrdiff_t>(filled), of_output.end(), 0.0f);
      addBlock(even);
    }
    outputs_from_local_.set(localFrame(glm::normalize(glm::dvec3(normal))));
    const auto indices = hemisphere.evenIndices().first(even);
    const auto turn = [&](GlossyMatrices& matrices, std::size_t first_column) {
      for (std::size_t c = 0; c < matrices.channels; ++c)
        turnOutputs(
            outputs_from_local_, indices, matrices.columns,
            {std::span<const float>(local_).subspan(c * bounce_.before.columns + first_column), stride},
            {matrices.at(s).subspan(c * matrices.matrixSize()), matrices.columns});
    };
    turn(now.environment, 0);
    if (now.lights.columns > 0) turn(now.lights, now.environment.columns);
  }

 private:
  // Adds the block's radiance to the matrix, and clears the block.
  void addBlock(std::size_t even) {
    const std::size_t stride = bounce_.before.vectorSize();
    for (std::size_t e = 0; e < even; ++e) {
      const std::array<float, kBlock> w = weights_[e];
      float* out = local_.data() + e * stride;
      const float* in = exits_.data();
      for (std::size_t i = 0; i < stride; ++i) {
        float sum = 0.0f;
        for (std::size_t h = 0; h < kBlock; ++h) sum += w[h] * in[h * stride + i];
        out[i] += sum;
      }
    }
    std::fill(exits_.begin(), exits_.end(), 0.0f);
  }

  const GlossyPass& pass_;
  const Bounce& bounce_;
  sh::Rotation outputs_from_local_;
  std::vector<float> exits_, local_, scratch_;
  std::array<std::array<float, kBlock>, kMostOutputs> weights_{};  // [output][hit of the block]
};

GlossyBounces::GlossyBounces(const GlossyPass& pass, const ExitKernels& kernels, const DirectResult& plain,
                             GlossyDirect& direct, int order_out)
    : pass_(pass), kernels_(kernels), diffuse_(plain), direct_(direct), order_out_(order_out) {
  const GlossyField& field = direct.field;
  assert(order_out <= field.order_out);
  assert(sh::coefficientCount(field.order_out) <= static_cast<int>(kMostOutputs));
  const auto first = plain.looks.valid.begin() + static_cast<std::ptrdiff_t>(pass.first());
  if (std::find(first, plain.looks.valid.end(), std::uint8_t{0}) != plain.looks.valid.end())
    edges_ = sampleEdges(pass.scene().geometry, pass.scene().samples);
  now_ = zero(field.order_out, 0);
  now_.environment.channels = 1;  // direct light of the environment has no colour
  now_.environment.values.assign(pass.size() * now_.environment.sampleSize(), 0.0f);
  now_.lights.values = field.lights_shadowed;
  parallelRanges(pass.size(), kSamplesPerRange, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      sh::addVisibilityMatrix(
          pass.gaunt(),
          std::span(field.visibility).subspan(s * field.visibilitySize(), field.visibilitySize()),
          now_.environment.at(s));
  });
  take(now_, nullptr, {});
  first_energies_ = energies_;
  advance();
}

GlossyBounces::State GlossyBounces::zero(int order, std::size_t samples) const {
  const GlossyField& field = direct_.field;
  const auto matrices = [&](std::size_t columns) {
    GlossyMatrices zero{.channels = field.channels,
                        .outputs = static_cast<std::size_t>(sh::coefficientCount(order)),
                        .columns = columns,
                        .values = {}};
    zero.values.assign(samples * zero.sampleSize(), 0.0f);
    return zero;
  };
  return {.environment = matrices(static_cast<std::size_t>(sh::coefficientCount(field.order_in))),
          .lights = matrices(field.light_columns)};
}

glm::vec3 GlossyBounces::addExit(const GatherHit& hit, const glm::uvec3& corners, const glm::vec3& to,
                                 float chance, float weight, std::span<float> sum) const {
  const float u = static_cast<float>(hit.u) * (1.0f / 65535.0f),
              v = static_cast<float>(hit.v) * (1.0f / 65535.0f);
  const std::size_t outputs = before_.environment.outputs, columns = before_.environment.columns;
  const std::uint32_t picked = chance < u ? corners.y : chance < u + v ? corners.z : corners.x;
  // The matrix is fetched while the kernel is computed.
  if (const auto matrix = before_.environment.at(picked - pass_.first()); chance >= 0.0f)
    for (std::size_t i = 0; i < matrix.size(); i += 16) __builtin_prefetch(matrix.data() + i);
  std::array<float, 3 * kMostOutputs> kernel;
  kernels_.at(hit.triangle, u, v, to, std::span(kernel).first(3 * outputs));
  const std::size_t channels = direct_.field.channels, lights = before_.lights.columns;
  const auto of = [&](const GlossyMatrices& matrices, std::size_t s, float share, std::size_t first) {
    float* out = sum.data() + first;
    if (matrices.channels < channels)  // one matrix for all channels is read once
      return contract<3>(kernel.data(), {matrices.at(s).data(), outputs, matrices.columns}, share, out,
                         columns + lights);
    for (std::size_t c = 0; c < channels; ++c, out += columns + lights)
      contract<1>(kernel.data() + c * outputs, {matrices.matrix(s, c).data(), outputs, matrices.columns},
                  share, out, 0);
  };
  const auto add = [&](std::uint32_t corner, float share) {
    const std::size_t s = corner - pass_.first();
    of(before_.environment, s, share, 0);
    if (lights > 0) of(before_.lights, s, share, columns);
  };
  if (chance < 0.0f) {
    add(corners.x, weight * (1.0f - u - v));
    add(corners.y, weight * u);
    add(corners.z, weight * v);
  } else {
    add(picked, weight);
  }
  return kUniform * glm::vec3(kernel[0], kernel[outputs], kernel[2 * outputs]);
}

glm::vec3 GlossyBounces::albedo(const GatherHit& hit, const glm::vec3& to) const {
  std::array<float, 3> constant;  // the kernel's first band alone
  kernels_.at(hit.triangle, static_cast<float>(hit.u) * (1.0f / 65535.0f),
              static_cast<float>(hit.v) * (1.0f / 65535.0f), to, constant);
  return kUniform * glm::vec3(constant[0], constant[1], constant[2]);
}

void GlossyBounces::visitHits(std::size_t sample, const ExitRadiance& exit, const TakeHit& take) const {
  const std::size_t s = sample - pass_.first();
  const GlossyHemisphere& hemisphere = pass_.hemisphereOf(diffuse_.looks.ray_counts[sample]);
  const glm::mat3 frame(localFrame(glm::normalize(glm::dvec3(pass_.scene().samples.normals[sample]))));
  const StoredHits hits(direct_.hits, pass_, s, s + 1);
  // Rays are uniform over the hemisphere, over which the cosine has the mean 1/2.
  const auto weight = [&](std::uint32_t ray) {
    return 2.0f * hemisphere.direction(ray).z * static_cast<float>(hemisphere.weight(ray));
  };
  for (const GatherHit& hit : hits.of(s))
    take(hit, weight(hit.ray), exit.albedo(hit, -(frame * hemisphere.direction(hit.ray))));
  exit.visitMirrored(hits.mirroredOf(s), weight, take);
}

bool GlossyBounces::gatherAt(const Receivers& at, const Bounce& bounce, State& now,
                             const BakeContext& context) const {
  const double share = std::min(bounce.growth * shareOfBefore(), 1.0);
  now = zero(at.pass.shape().order_out, at.pass.size());
  const auto gatherRange = [&](std::size_t begin, std::size_t end) {
    const StoredHits hits(at.hits, at.pass, begin, end);
    Walk walk(at.pass, bounce);
    for (std::size_t s = begin; s < end; ++s) {
      const GlossyHemisphere& hemisphere = at.pass.hemisphereOf(at.looks.ray_counts[at.pass.first() + s]);
      walk.gather(s, hits, raysTogether(share, hemisphere.table().size()), hemisphere, now);
    }
  };
  return runStage({.count = at.pass.size(),
                   .grain = kSamplesGathered,
                   .writes = {rowsOf(now.environment.values, now.environment.sampleSize()),
                              rowsOf(now.lights.values, now.lights.sampleSize())},
                   .compute = gatherRange},
                  context)
      .has_value();
}

bool GlossyBounces::fitInside(const Bounce& bounce, const BakeContext& context) {
  const GlossyInsideFaces& inside = *direct_.inside;
  const TracedGlossyPoints& points = inside.points();
  context.progress.begin(fmt::format("bounce {} inside faces", bounce.number), points.size(), "samples");
  State there;
  return gatherAt({points.pass(), points.direct().hits, points.looks()}, bounce, there, context) &&
         inside.fit(there.environment.values, now_.environment.values, context.stop) &&
         inside.fit(there.lights.values, now_.lights.values, context.stop);
}

bool GlossyBounces::watch(const Bounce& bounce, const BakeContext& context) const {
  for (const auto& points : direct_.watched) {
    State there;
    if (!gatherAt({points->pass(), points->direct().hits, points->looks()}, bounce, there,
                  context.keyed(Key{})))
      return false;
    std::vector<float>& sum = points->direct().field.bounced;
    sum.resize(there.environment.values.size());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += there.environment.values[i];
  }
  return true;
}

bool GlossyBounces::gather(const Bounce& bounce, TransferField& now, const BakeContext& context) {
  if (!gatherAt({pass_, direct_.hits, diffuse_.looks}, bounce, now_, context)) return false;
  if (!edges_.empty()) {
    fillStretchFromNeighbours(edges_, diffuse_.looks.valid, pass_.first(), now_.environment.sampleSize(),
                              now_.environment.values);
    if (now_.lights.columns > 0)
      fillStretchFromNeighbours(edges_, diffuse_.looks.valid, pass_.first(), now_.lights.sampleSize(),
                                now_.lights.values);
  }
  if (direct_.inside && !fitInside(bounce, context.part("inside faces"))) return false;
  if (!watch(bounce, context)) return false;
  if (sum_.environment.values.empty()) sum_ = zero(order_out_, pass_.size());
  return take(now_, &now, context.stop);
}

bool GlossyBounces::take(const State& state, TransferField* plain, const std::stop_token& stop) {
  // Only outputs of order_out_ bands count.
  const std::size_t columns = state.environment.columns, lights = state.lights.columns,
                    outputs = static_cast<std::size_t>(sh::coefficientCount(order_out_));
  std::vector<float> power(columns);
  for (std::size_t i = 0; i < columns; ++i)
    power[i] = static_cast<float>(kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)))]);
  const std::size_t ranges = (pass_.size() + kSamplesPerRange - 1) / kSamplesPerRange;
  std::vector<std::vector<double>> parts(ranges, std::vector<double>(1 + lights, 0.0));
  const auto add = [](const GlossyMatrices& part, std::size_t s, GlossyMatrices& sum) {
    for (std::size_t c = 0; c < sum.channels; ++c) {
      const auto from = part.matrix(s, c);
      const auto to = sum.at(s).subspan(c * sum.matrixSize(), sum.matrixSize());
      for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
    }
  };
  const auto plainOf = [&](const GlossyMatrices& matrices, std::size_t s, std::size_t first_column) {
    const auto out = plain->at(pass_.first() + s);
    for (std::size_t c = 0; c < plain->channels; ++c)
      diffuseTransfer(order_out_, pass_.scene().samples.normals[pass_.first() + s], matrices.matrix(s, c),
                      out.subspan(c * plain->columns + first_column, matrices.columns));
  };
  const bool taken =
      parallelRanges(pass_.size(), kSamplesPerRange, stop, [&](std::size_t begin, std::size_t end) {
        std::vector<double>& sums = parts[begin / kSamplesPerRange];
        for (std::size_t s = begin; s < end; ++s) {
          for (std::size_t c = 0; c < state.environment.channels; ++c) {
            const auto matrix = state.environment.matrix(s, c).first(outputs * columns);
            for (std::size_t row = 0; row < matrix.size(); row += columns) {
              float sum = 0.0f;
              for (std::size_t i = 0; i < columns; ++i) sum += power[i] * matrix[row + i] * matrix[row + i];
              sums[0] += double{sum};
            }
          }
          for (std::size_t c = 0; lights > 0 && c < state.lights.channels; ++c) {
            const auto matrix = state.lights.matrix(s, c).first(outputs * lights);
            for (std::size_t at = 0; at < matrix.size(); ++at)
              sums[1 + at % lights] += double{matrix[at]} * double{matrix[at]};
          }
          if (!plain) continue;
          add(state.environment, s, sum_.environment);
          add(state.lights, s, sum_.lights);
          plainOf(state.environment, s, 0);
          if (lights > 0) plainOf(state.lights, s, columns);
        }
      });
  energies_.assign(1 + lights, 0.0);
  for (const auto& sums : parts)
    for (std::size_t k = 0; k < sums.size(); ++k) energies_[k] += sums[k];
  for (std::size_t k = 0; k < energies_.size(); ++k) {
    const std::size_t channels = k == 0 ? state.environment.channels : state.lights.channels;
    energies_[k] =
        std::sqrt(energies_[k] / static_cast<double>(std::max<std::size_t>(pass_.size() * channels, 1)));
  }
  return taken;
}

double GlossyBounces::shareOfBefore() const {
  double share = 0.0;
  for (std::size_t k = 0; k < energies_.size(); ++k)
    if (energies_[k] > 0.0) share = std::max(share, std::min(energies_[k] / first_energies_[k], 1.0));
  return share;
}

void GlossyBounces::advance() {
  before_ = std::move(now_);
  now_ = {};
}

void GlossyBounces::finish() {
  before_ = {}, now_ = {};
  GlossyField& field = direct_.field;
  field.keepBands(order_out_);
  field.bounced = std::move(sum_.environment.values);
  field.lights_full = std::move(sum_.lights.values);
  if (field.lights_full.empty())
    field.lights_full = field.lights_shadowed;
  else
    for (std::size_t i = 0; i < field.lights_full.size(); ++i)
      field.lights_full[i] += field.lights_shadowed[i];
}

}  // namespace lambent::baker
