#include "baker/effects/glossy/glossy_bounces.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <glm/geometric.hpp>

#include "baker/compress/light_weights.hpp"
#include "baker/effects/diffuse/fill.hpp"
#include "baker/transport/frame.hpp"
#include "baker/work/parallel.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kMostOutputs = 36;
// Hits whose radiance is added to a matrix at once.
constexpr std::size_t kBlock = 8;

// out[i] += Σ_k kernel[k] matrix[k * Columns + i]
template <std::size_t Columns>
void contract(std::span<const float> kernel, const float* matrix, float weight, float* out) {
  std::array<float, Columns> sum{};
  for (const float k : kernel) {
    for (std::size_t i = 0; i < Columns; ++i) sum[i] += k * matrix[i];
    matrix += Columns;
  }
  for (std::size_t i = 0; i < Columns; ++i) out[i] += weight * sum[i];
}

void contract(std::span<const float> kernel, std::span<const float> matrix, std::size_t columns, float weight,
              float* out) {
  switch (columns) {
    case 16:
      return contract<16>(kernel, matrix.data(), weight, out);
    case 25:
      return contract<25>(kernel, matrix.data(), weight, out);
    case 36:
      return contract<36>(kernel, matrix.data(), weight, out);
    default:
      for (std::size_t k = 0; k < kernel.size(); ++k)
        for (std::size_t i = 0; i < columns; ++i) out[i] += weight * kernel[k] * matrix[k * columns + i];
  }
}

}  // namespace

// One thread's way through a range of samples.
class GlossyBounces::Walk {
 public:
  Walk(const GlossyBounces& bounces, const TransferField& before)
      : pass_(bounces.pass_),
        before_(before),
        outputs_from_local_(glm::dmat3(1.0), bounces.direct_.field.order_out),
        exits_(kBlock * before.vectorSize()) {}

  // matrices: of the sample, in the group's frame.
  void gather(std::size_t sample, std::span<const GatherHit> hits, float scale,
              const GlossyHemisphere& hemisphere, const ExitToSample& exit, std::size_t s, State& now) {
    if (hits.empty()) return;
    const std::size_t stride = before_.vectorSize(), even = hemisphere.evenOutputs();
    local_.assign(even * stride, 0.0f);
    for (std::size_t first = 0; first < hits.size(); first += kBlock)
      addBlock(hits.subspan(first, std::min(kBlock, hits.size() - first)), scale, hemisphere, exit);
    outputs_from_local_.set(localFrame(glm::normalize(glm::dvec3(pass_.scene().samples.normals[sample]))));
    const auto indices = hemisphere.evenIndices().first(even);
    const auto turn = [&](GlossyMatrices& matrices, std::size_t first_column) {
      for (std::size_t c = 0; c < matrices.channels; ++c)
        turnOutputs(outputs_from_local_, indices, matrices.columns,
                    std::span<const float>(local_).subspan(c * before_.columns + first_column), stride,
                    matrices.at(s).subspan(c * matrices.matrixSize()), matrices.columns);
    };
    turn(now.environment, 0);
    if (now.lights.columns > 0) turn(now.lights, now.environment.columns);
  }

 private:
  void addBlock(std::span<const GatherHit> hits, float scale, const GlossyHemisphere& hemisphere,
                const ExitToSample& exit) {
    const std::size_t stride = before_.vectorSize(), even = hemisphere.evenOutputs();
    std::fill(exits_.begin(), exits_.end(), 0.0f);
    std::array<std::array<float, kBlock>, kMostOutputs> weights{};  // of each output
    for (std::size_t h = 0; h < hits.size(); ++h) {
      exit.add(hits[h], scale, before_, std::span(exits_).subspan(h * stride, stride));
      const auto row = hemisphere.row(hits[h].ray);
      for (std::size_t e = 0; e < even; ++e) weights[e][h] = row[e];
    }
    for (std::size_t e = 0; e < even; ++e) {
      const std::array<float, kBlock> w = weights[e];
      float* out = local_.data() + e * stride;
      const float* in = exits_.data();
      for (std::size_t i = 0; i < stride; ++i) {
        float sum = 0.0f;
        for (std::size_t h = 0; h < kBlock; ++h) sum += w[h] * in[h * stride + i];
        out[i] += sum;
      }
    }
  }

  const GlossyPass& pass_;
  const TransferField& before_;
  sh::Rotation outputs_from_local_;
  std::vector<float> exits_, local_;
};

GlossyBounces::GlossyBounces(const GlossyPass& pass, const ExitKernels& kernels, const DirectResult& plain,
                             GlossyDirect& direct)
    : pass_(pass), kernels_(kernels), plain_(plain), direct_(direct) {
  const GlossyField& field = direct.field;
  assert(sh::coefficientCount(field.order_out) <= static_cast<int>(kMostOutputs));
  const auto first = plain.looks.valid.begin() + static_cast<std::ptrdiff_t>(pass.first());
  if (std::find(first, plain.looks.valid.end(), std::uint8_t{0}) != plain.looks.valid.end())
    edges_ = sampleEdges(pass.scene().geometry, pass.scene().samples);
  now_ = zero();
  now_.environment.channels = 1;  // what is not reflected has no colour
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
  advance();
}

GlossyBounces::State GlossyBounces::zero() const {
  const GlossyField& field = direct_.field;
  const auto outputs = static_cast<std::size_t>(sh::coefficientCount(field.order_out));
  const auto columns = static_cast<std::size_t>(sh::coefficientCount(field.order_in));
  return {.environment = {.channels = field.channels, .outputs = outputs, .columns = columns, .values = {}},
          .lights = {
              .channels = field.channels, .outputs = outputs, .columns = field.light_columns, .values = {}}};
}

void GlossyBounces::addExit(const GatherHit& hit, const glm::uvec3& corners, const glm::vec3& to,
                            float chance, float weight, std::span<float> sum) const {
  const float u = static_cast<float>(hit.u) * (1.0f / 65535.0f),
              v = static_cast<float>(hit.v) * (1.0f / 65535.0f);
  const std::size_t outputs = before_.environment.outputs, columns = before_.environment.columns;
  std::array<float, 3 * kMostOutputs> kernel;
  kernels_.at(hit.triangle, u, v, to, std::span(kernel).first(3 * outputs));
  const std::size_t channels = direct_.field.channels, lights = before_.lights.columns;
  const auto add = [&](std::uint32_t corner, float share) {
    const std::size_t s = corner - pass_.first();
    for (std::size_t c = 0; c < channels; ++c) {
      const auto k = std::span<const float>(kernel).subspan(c * outputs, outputs);
      float* out = sum.data() + c * (columns + lights);
      contract(k, before_.environment.matrix(s, c), columns, share, out);
      if (lights > 0) contract(k, before_.lights.matrix(s, c), lights, share, out + columns);
    }
  };
  if (chance < 0.0f) {
    add(corners.x, weight * (1.0f - u - v));
    add(corners.y, weight * u);
    add(corners.z, weight * v);
  } else {
    add(chance < u ? corners.y : chance < u + v ? corners.z : corners.x, weight);
  }
}

bool GlossyBounces::gather(int bounce, bool thinly, const ExitRadiance& exit, const TransferField& before,
                           TransferField& now, Progress& progress, const std::stop_token& stop) {
  const std::size_t first = pass_.first();
  now_ = zero();
  now_.environment.values.assign(pass_.size() * now_.environment.sampleSize(), 0.0f);
  now_.lights.values.assign(pass_.size() * now_.lights.sampleSize(), 0.0f);
  const bool gathered =
      parallelRanges(pass_.size(), kSamplesPerRange, stop, [&](std::size_t begin, std::size_t end) {
        RangeHits again;
        const RangeHits* hits = &direct_.hits.range(begin / kSamplesPerRange);
        if (!hits->kept) {
          pass_.traceAgain(begin, end, again);
          hits = &again;
        }
        Walk walk(*this, before);
        std::vector<GatherHit> thinned;
        for (std::size_t s = begin; s < end; ++s) {
          const std::size_t sample = first + s;
          const GlossyHemisphere& hemisphere = pass_.hemisphereOf(plain_.looks.closely[sample] != 0);
          auto own = hits->of(s - begin);
          const float scale = thinly ? thinHits(bounce, hemisphere, own, thinned) : 1.0f;
          const ExitToSample to_sample(exit, hemisphere.table(), pass_.scene().samples.normals[sample],
                                       sample, bounce, thinly);
          walk.gather(sample, own, scale, hemisphere, to_sample, s, now_);
        }
        progress.add(end - begin);
      });
  if (!gathered) return false;
  if (!edges_.empty()) {
    fillStretchFromNeighbours(edges_, plain_.looks.valid, first, now_.environment.sampleSize(),
                              now_.environment.values);
    if (now_.lights.columns > 0)
      fillStretchFromNeighbours(edges_, plain_.looks.valid, first, now_.lights.sampleSize(),
                                now_.lights.values);
  }
  if (sum_.environment.values.empty()) {
    sum_ = zero();
    sum_.environment.values.assign(now_.environment.values.size(), 0.0f);
    sum_.lights.values.assign(now_.lights.values.size(), 0.0f);
  }
  return take(now_, &now, stop);
}

bool GlossyBounces::take(const State& state, TransferField* plain, const std::stop_token& stop) {
  const std::size_t columns = state.environment.columns, lights = state.lights.columns;
  std::vector<float> power(columns);
  for (std::size_t i = 0; i < columns; ++i)
    power[i] = static_cast<float>(kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)))]);
  const std::size_t ranges = (pass_.size() + kSamplesPerRange - 1) / kSamplesPerRange;
  std::vector<std::vector<double>> parts(ranges, std::vector<double>(1 + lights, 0.0));
  const auto add = [](std::span<const float> part, std::span<float> sum) {
    for (std::size_t i = 0; i < part.size(); ++i) sum[i] += part[i];
  };
  const auto plainOf = [&](const GlossyMatrices& matrices, std::size_t s, std::size_t first_column) {
    const auto out = plain->at(pass_.first() + s);
    for (std::size_t c = 0; c < plain->channels; ++c)
      plainTransfer(direct_.field.order_out, pass_.scene().samples.normals[pass_.first() + s],
                    matrices.matrix(s, c), out.subspan(c * plain->columns + first_column, matrices.columns));
  };
  const bool taken =
      parallelRanges(pass_.size(), kSamplesPerRange, stop, [&](std::size_t begin, std::size_t end) {
        std::vector<double>& sums = parts[begin / kSamplesPerRange];
        for (std::size_t s = begin; s < end; ++s) {
          const auto environment = state.environment.at(s), of_lights = state.lights.at(s);
          for (std::size_t row = 0; row < environment.size(); row += columns) {
            float sum = 0.0f;
            for (std::size_t i = 0; i < columns; ++i)
              sum += power[i] * environment[row + i] * environment[row + i];
            sums[0] += double{sum};
          }
          for (std::size_t at = 0; at < of_lights.size(); ++at)
            sums[1 + at % lights] += double{of_lights[at]} * double{of_lights[at]};
          if (!plain) continue;
          add(environment, sum_.environment.at(s));
          add(of_lights, sum_.lights.at(s));
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

void GlossyBounces::advance() {
  before_ = std::move(now_);
  now_ = {};
}

void GlossyBounces::finish() {
  before_ = {}, now_ = {};
  GlossyField& field = direct_.field;
  field.bounced = std::move(sum_.environment.values);
  field.lights_full = std::move(sum_.lights.values);
  if (field.lights_full.empty())
    field.lights_full = field.lights_shadowed;
  else
    for (std::size_t i = 0; i < field.lights_full.size(); ++i)
      field.lights_full[i] += field.lights_shadowed[i];
}

}  // namespace lambent::baker
