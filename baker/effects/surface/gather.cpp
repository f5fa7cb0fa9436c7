#include "baker/effects/surface/gather.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "baker/compress/cpca.hpp"
#include "baker/effects/surface/inside_faces.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::baker {

// Received are the hits of a sample's rays and the exit radiance towards it. Hits are weighted by `scale`,
// light by way of mirrors by `scale_mirrored`.
struct BounceGather::Received {
  std::span<const GatherHit> hits;
  std::span<const MirroredLight> mirrored;
  float scale, scale_mirrored;
  const Hemisphere& hemisphere;
  const ExitToSample& exit;
};

void BounceGather::visitHits(std::size_t sample, const TakeHit& take) const {
  const Hemisphere& hemisphere = hemisphereOf(sample);
  const SurfacePart part =
      sample < pass_.scene().samples.glossy.begin ? SurfacePart::Matte : SurfacePart::Glossy;
  const StoredHits hits(direct_.of(part).hits, pass_, sample, sample + 1);
  const glm::mat3 frame(localFrame(glm::normalize(glm::dvec3(normalOf(sample)))));
  const float scale = hits.scaleOf(sample);
  const auto weight_of = [&](std::uint32_t ray) { return scale * hemisphere.irradianceWeight(ray); };
  for (const GatherHit& hit : hits.of(sample))
    take(hit, weight_of(hit.ray), exit_.albedo(hit, -(frame * hemisphere.direction(hit.ray))));
  exit_.visitMirrored(hits.mirroredOf(sample), weight_of, take);
}

void BounceGather::matte(const Bounce& bounce, std::size_t begin, std::size_t end, TransferField& now,
                         TransferField& mapped) const {
  std::vector<GatherHit> thinned;
  std::vector<float> scratch;
  const StoredHits hits(direct_.of(SurfacePart::Matte).hits, pass_, begin, end);
  const std::size_t first_mapped = pass_.scene().samples.normal_mapped.begin;
  for (std::size_t s = begin; s < end; ++s) {
    const Hemisphere& hemisphere = hemisphereOf(s);
    const ExitToSample exit(bounce, hemisphere.table(), normalOf(s), s);
    const float kept = hits.scaleOf(s);
    Received received{hits.of(s), hits.mirroredOf(s), kept, kept, hemisphere, exit};
    if (bounce.thinly) received.scale *= thinHits(bounce.number, hemisphere, received.hits, thinned);
    if (s < first_mapped) {
      exit.addAll(
          received.hits,
          [&](std::uint32_t ray) { return received.scale * static_cast<float>(hemisphere.weight(ray)); },
          now.at(s));
      scratch.resize(now.vectorSize());
      for (const MirroredLight& light : received.mirrored)
        exit.addMirrored(light, kept * static_cast<float>(hemisphere.weight(light.hit.ray)), scratch,
                         now.at(s));
    } else {
      gatherMapped(s, received, now.at(s), mapped.at(s - first_mapped));
    }
  }
}

void BounceGather::gatherMapped(std::size_t sample, const Received& received, std::span<float> out,
                                std::span<float> mapped) const {
  const std::size_t stride = out.size();
  std::vector<float> exit(stride, 0.0f), scratch(stride), local(kIncident * stride, 0.0f);
  // Adds what was found along a ray, and clears it.
  const auto addExit = [&](std::uint32_t ray) {
    const auto row = received.hemisphere.row(ray);
    for (std::size_t i = 0; i < stride; ++i) out[i] += row[0] * exit[i];
    for (std::size_t j = 0; j < kIncident; ++j)
      for (std::size_t i = 0; i < stride; ++i) local[j * stride + i] += row[1 + j] * exit[i];
    std::fill(exit.begin(), exit.end(), 0.0f);
  };
  for (const GatherHit& hit : received.hits) {
    received.exit.add(hit, received.scale, exit);
    addExit(hit.ray);
  }
  for (const MirroredLight& light : received.mirrored) {
    if (!received.exit.brings(light)) continue;
    received.exit.addMirrored(light, received.scale_mirrored, scratch, exit);
    addExit(light.hit.ray);
  }
  if (received.hits.empty() && received.mirrored.empty()) return;
  const sh::Rotation group_from_local(localFrame(glm::normalize(glm::dvec3(normalOf(sample)))), 3);
  received.hemisphere.turn(group_from_local, stride, {local, stride}, {local, stride});
  for (std::size_t i = 0; i < mapped.size(); ++i) mapped[i] += local[i];
}

namespace {

// Number of hits whose radiance is added to a matrix at once.
constexpr std::size_t kBlock = 8;

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

}  // namespace

// A GlossyWalk is one thread's way through a range of glossy samples.
class BounceGather::GlossyWalk {
 public:
  // Both arguments must outlive this.
  GlossyWalk(const BounceGather& gather, const Bounce& bounce)
      : gather_(gather),
        bounce_(bounce),
        outputs_from_local_(glm::dmat3(1.0), gather.direct_.glossy.order_out),
        exits_(kBlock * bounce.before.vectorSize()) {}

  // Gathers at sample `s` of the set. Hits in a row of `together` rays (raysTogether) share the exit radiance
  // of one of them.
  void gather(std::size_t s, const StoredHits& stored, std::uint32_t together, GlossyLight& now) {
    const std::span<const GatherHit> hits = stored.of(s);
    const std::span<const MirroredLight> mirrored = stored.mirroredOf(s);
    if (hits.empty() && mirrored.empty()) return;
    const Hemisphere& hemisphere = gather_.hemisphereOf(s);
    const glm::vec3 normal = gather_.normalOf(s);
    const ExitToSample exit(bounce_, hemisphere.table(), normal, s);
    const std::size_t stride = bounce_.before.vectorSize(), even = hemisphere.outputs();
    local_.assign(even * stride, 0.0f);
    std::fill(exits_.begin(), exits_.end(), 0.0f);
    std::size_t filled = 0;
    for (std::size_t first = 0, last = 0; first < hits.size(); first = last) {
      const std::uint32_t row = hits[first].ray / together;
      std::array<float, kMostGlossyOutputs> weights{};
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
    const auto turn = [&](GlossyMatrices& matrices, std::size_t first_column) {
      const auto out = matrices.at(s - gather_.direct_.glossy.first_sample);
      for (std::size_t c = 0; c < matrices.channels; ++c)
        hemisphere.turn(
            outputs_from_local_, matrices.columns,
            {std::span<const float>(local_).subspan(c * bounce_.before.columns + first_column), stride},
            {out.subspan(c * matrices.matrixSize()), matrices.columns});
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

  const BounceGather& gather_;
  const Bounce& bounce_;
  sh::Rotation outputs_from_local_;
  std::vector<float> exits_, local_, scratch_;
  std::array<std::array<float, kBlock>, kMostGlossyOutputs> weights_{};  // [output][hit of the block]
};

void BounceGather::glossy(const Bounce& bounce, double share, std::size_t begin, std::size_t end,
                          GlossyLight& now) const {
  const std::size_t first = direct_.glossy.first_sample;
  const StoredHits hits(direct_.of(SurfacePart::Glossy).hits, pass_, first + begin, first + end);
  GlossyWalk walk(*this, bounce);
  for (std::size_t s = first + begin; s < first + end; ++s)
    walk.gather(s, hits, raysTogether(share, hemisphereOf(s).table().size()), now);
}

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
      fillFromNeighbours(edges, light_.direct.looks.valid, exit_.first_sample, part->sampleSize(),
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
