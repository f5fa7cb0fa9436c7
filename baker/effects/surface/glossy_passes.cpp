#include "baker/effects/surface/glossy_passes.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "baker/compress/light_weights.hpp"
#include "baker/effects/surface/gather.hpp"
#include "baker/effects/surface/inside_faces.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/trace/transfer_field.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

// Keeps the first `to` of each `from` values in a row, in place.
void keepFirst(std::size_t from, std::size_t to, std::vector<float>& values) {
  assert(to <= from);
  if (values.empty() || from == to) return;
  const std::size_t rows = values.size() / from;
  for (std::size_t row = 0; row < rows; ++row)
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(row * from), to,
                values.begin() + static_cast<std::ptrdiff_t>(row * to));
  values.resize(rows * to);
  values.shrink_to_fit();
}

}  // namespace

GlossyPasses::GlossyPasses(const LightToBounce& light, int order_out)
    : light_(light),
      count_(light.pass.scene().samples.glossy.size()),
      order_out_(order_out),
      exit_{.kernels = *light.kernels, .first_sample = light.direct.glossy.first_sample} {
  const GlossyField& field = light.direct.glossy;
  assert(order_out <= field.order_out && squared(field.order_out) <= kMostGlossyOutputs);
  now_ = zero(field.order_out, 0);
  now_.environment.channels = 1;  // direct light of the environment has no colour
  now_.environment.values.assign(count_ * now_.environment.sampleSize(), 0.0f);
  now_.lights.values = field.lights_shadowed;
  parallelRanges(count_, kSamplesPerRange, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      sh::addVisibilityMatrix(light.pass.gaunt(), field.visibilityOf(s), now_.environment.at(s));
  });
  take(now_, nullptr, {});
  first_energies_ = energies_;
  advance();
}

GlossyLight GlossyPasses::zero(int order, std::size_t samples) const {
  const GlossyField& field = light_.direct.glossy;
  const auto matrices = [&](std::size_t columns) {
    GlossyMatrices zero{
        .channels = field.channels, .outputs = squared(order), .columns = columns, .values = {}};
    zero.values.assign(samples * zero.sampleSize(), 0.0f);
    return zero;
  };
  return {.environment = matrices(squared(field.order_in)), .lights = matrices(field.light_columns)};
}

bool GlossyPasses::gatherAt(const DirectPass& pass, const DirectResult& direct, const Bounce& bounce,
                            GlossyLight& now, const BakeContext& context) const {
  const double share = std::min(bounce.growth * shareOfBefore(), 1.0);
  const std::size_t count = pass.scene().samples.glossy.size();
  now = zero(pass.settings().order_out, count);
  const BounceGather gather(pass, direct, bounce.exit);
  return runStage({.count = count,
                   .grain = kSamplesGathered,
                   .writes = {rowsOf(now.environment.values, now.environment.sampleSize()),
                              rowsOf(now.lights.values, now.lights.sampleSize())},
                   .compute = [&](std::size_t begin,
                                  std::size_t end) { gather.glossy(bounce, share, begin, end, now); }},
                  context)
      .has_value();
}

bool GlossyPasses::fitInside(const Bounce& bounce, const BakeContext& context) {
  const InsideFaces& inside = *light_.inside(SurfacePart::Glossy);
  const TracedPoints& points = inside.points();
  context.progress.begin(fmt::format("bounce {} inside faces", bounce.number), points.size(), "samples");
  GlossyLight there;
  const auto fit = [&](const GlossyMatrices& from, GlossyMatrices& to) {
    return inside.fit(SampleKind::Glossy, from.values, to.values, context.stop);
  };
  return gatherAt(points.pass(), points.direct, bounce, there, context) &&
         fit(there.environment, now_.environment) && fit(there.lights, now_.lights);
}

bool GlossyPasses::watch(const Bounce& bounce, const BakeContext& context) const {
  for (TracedPoints* const points : light_.watched) {
    if (points->points().samples.glossy.empty()) continue;
    GlossyLight there;
    if (!gatherAt(points->pass(), points->direct, bounce, there, context.keyed(Key{}))) return false;
    std::vector<float>& sum = points->direct.glossy.bounced;
    sum.resize(there.environment.values.size());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += there.environment.values[i];
  }
  return true;
}

bool GlossyPasses::gather(const Bounce& bounce, const SampleEdges& edges, TransferField& now,
                          const BakeContext& context) {
  if (!gatherAt(light_.pass, light_.direct, bounce, now_, context)) return false;
  for (GlossyMatrices* const part : {&now_.environment, &now_.lights})
    if (!edges.empty())
      fillStretchFromNeighbours(edges, light_.direct.looks.valid, exit_.first_sample, part->sampleSize(),
                                part->values);
  if (light_.inside(SurfacePart::Glossy) && !fitInside(bounce, context.part("inside faces"))) return false;
  if (!watch(bounce, context)) return false;
  if (sum_.environment.values.empty()) sum_ = zero(order_out_, count_);
  return take(now_, &now, context.stop);
}

bool GlossyPasses::take(const GlossyLight& state, TransferField* plain, const std::stop_token& stop) {
  // Only outputs of order_out_ bands count.
  const std::size_t columns = state.environment.columns, lights = state.lights.columns,
                    outputs = squared(order_out_);
  std::vector<float> power(columns);
  for (std::size_t i = 0; i < columns; ++i)
    power[i] = static_cast<float>(kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)))]);
  const std::size_t ranges = (count_ + kSamplesPerRange - 1) / kSamplesPerRange;
  std::vector<std::vector<double>> parts(ranges, std::vector<double>(1 + lights, 0.0));
  const auto add = [](const GlossyMatrices& part, std::size_t s, GlossyMatrices& sum) {
    for (std::size_t c = 0; c < sum.channels; ++c) {
      const auto from = part.matrix(s, c);
      const auto to = sum.at(s).subspan(c * sum.matrixSize(), sum.matrixSize());
      for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
    }
  };
  const auto plainOf = [&](const GlossyMatrices& matrices, std::size_t s, std::size_t first_column) {
    const auto out = plain->at(exit_.first_sample + s);
    for (std::size_t c = 0; c < plain->channels; ++c)
      diffuseTransfer(order_out_, light_.pass.scene().samples.normals[exit_.first_sample + s],
                      matrices.matrix(s, c),
                      out.subspan(c * plain->columns + first_column, matrices.columns));
  };
  const bool taken = parallelRanges(count_, kSamplesPerRange, stop, [&](std::size_t begin, std::size_t end) {
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
    energies_[k] = std::sqrt(energies_[k] / static_cast<double>(std::max<std::size_t>(count_ * channels, 1)));
  }
  return taken;
}

double GlossyPasses::shareOfBefore() const {
  double share = 0.0;
  for (std::size_t k = 0; k < energies_.size(); ++k)
    if (energies_[k] > 0.0) share = std::max(share, std::min(energies_[k] / first_energies_[k], 1.0));
  return share;
}

void GlossyPasses::advance() {
  exit_.light = std::exchange(now_, {});
}

void GlossyPasses::finish() {
  exit_.light = {}, now_ = {};
  GlossyField& field = light_.direct.glossy;
  const std::size_t visible = field.visibilitySize(), outputs = squared(field.order_out);
  field.order_out = order_out_;
  keepFirst(visible, field.visibilitySize(), field.visibility);
  keepFirst(outputs * field.light_columns, squared(order_out_) * field.light_columns, field.lights_shadowed);
  field.bounced = std::move(sum_.environment.values);
  field.lights_full = std::move(sum_.lights.values);
  if (field.lights_full.empty())
    field.lights_full = field.lights_shadowed;
  else
    for (std::size_t i = 0; i < field.lights_full.size(); ++i)
      field.lights_full[i] += field.lights_shadowed[i];
}

}  // namespace lambent::baker
