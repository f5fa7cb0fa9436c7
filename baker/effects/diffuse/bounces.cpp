#include "baker/effects/diffuse/bounces.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "baker/compress/light_weights.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/trace/fill.hpp"
#include "baker/transport/frame.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::baker {

namespace {

// Once a pass has less than this share of all light, its rays are thinned: their noise, a percent of at most
// a percent, is not visible.
constexpr double kShareToThin = 0.01;

// Returns the energy of a field for each light source: the environment first, then each light of the group.
std::vector<double> energies(const TransferField& field) {
  const auto bands = static_cast<std::size_t>(sh::coefficientCount(field.order));
  std::vector<double> sums(1 + field.columns - bands, 0.0);
  const std::size_t samples = field.size();
  for (std::size_t s = 0; s < samples; ++s) {
    const auto vector = field.at(s);
    for (std::size_t at = 0; at < vector.size(); ++at) {
      const std::size_t column = at % field.columns;
      const double square = double{vector[at]} * double{vector[at]};
      if (column < bands)
        sums[0] += kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(column)))] * square;
      else
        sums[1 + column - bands] += square;
    }
  }
  for (double& sum : sums)
    sum = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(samples * field.channels, 1)));
  return sums;
}

void add(const TransferField& part, TransferField& sum) {
  for (std::size_t i = 0; i < sum.vectors.size(); ++i) sum.vectors[i] += part.vectors[i];
}

TransferField zeroLike(const TransferField& field) {
  TransferField zero = field;
  std::fill(zero.vectors.begin(), zero.vectors.end(), 0.0f);
  zero.rays = 0, zero.filled_samples = 0;
  return zero;
}

class Gather {
 public:
  Gather(const DirectPass& pass, const DirectResult& direct, const DiffuseScene& scene)
      : pass_(pass), direct_(direct), scene_(scene) {}

  // Gathers at samples [begin, end). Adds to `mapped`, which is in the group's frame.
  void range(const Bounce& bounce, std::size_t begin, std::size_t end, TransferField& now,
             TransferField& mapped) const {
    std::vector<GatherHit> thinned;
    const StoredHits hits(direct_.hits, pass_, begin, end);
    const std::size_t first_mapped = scene_.samples.first_normal_mapped;
    for (std::size_t s = begin; s < end; ++s) {
      const Hemisphere& hemisphere = pass_.hemisphereOf(s, direct_.looks.double_rays[s] != 0);
      const ExitToSample exit(bounce, hemisphere.table(), scene_.samples.normals[s], s);
      Received received{hits.of(s), 1.0f, hemisphere, exit};
      if (bounce.thinly) received.scale = thinHits(bounce.number, hemisphere, received.hits, thinned);
      if (s < first_mapped)
        gatherPlain(received, now.at(s));
      else
        gatherMapped(s, received, now.at(s), mapped.at(s - first_mapped));
    }
  }

 private:
  // Received are the hits of a sample's rays and the exit radiance towards it; hits are weighted by `scale`.
  struct Received {
    std::span<const GatherHit> hits;
    float scale;
    const Hemisphere& hemisphere;
    const ExitToSample& exit;
  };

  static void gatherPlain(const Received& received, std::span<float> out) {
    for (const GatherHit& hit : received.hits)
      received.exit.add(hit, received.scale * static_cast<float>(received.hemisphere.weight(hit.ray)), out);
  }

  void gatherMapped(std::size_t sample, const Received& received, std::span<float> out,
                    std::span<float> mapped) const {
    const std::size_t stride = out.size();
    std::vector<float> exit(stride), local(kIncident * stride, 0.0f);
    for (const GatherHit& hit : received.hits) {
      std::fill(exit.begin(), exit.end(), 0.0f);
      received.exit.add(hit, received.scale, exit);
      const auto weight = static_cast<float>(received.hemisphere.weight(hit.ray));
      for (std::size_t i = 0; i < stride; ++i) out[i] += weight * exit[i];
      const auto& weights = received.hemisphere.incidentWeight(hit.ray);
      for (std::size_t j = 0; j < kIncident; ++j)
        for (std::size_t i = 0; i < stride; ++i) local[j * stride + i] += weights[j] * exit[i];
    }
    if (received.hits.empty()) return;
    const sh::Rotation group_from_local(
        localFrame(glm::normalize(glm::dvec3(scene_.samples.normals[sample]))), 3);
    std::array<float, kIncident> from, to;
    for (std::size_t at = 0; at < stride; ++at) {
      for (std::size_t j = 0; j < kIncident; ++j) from[j] = local[j * stride + at];
      group_from_local.apply(std::span<const float>(from), std::span<float>(to));
      for (std::size_t j = 0; j < kIncident; ++j) mapped[j * stride + at] += to[j];
    }
  }

  const DirectPass& pass_;
  const DirectResult& direct_;
  const DiffuseScene& scene_;
};

// Returns the largest share of all light that a pass has, over the light sources.
double shareOf(const std::vector<double>& pass, const std::vector<double>& all) {
  double share = 0.0;
  for (std::size_t k = 0; k < pass.size(); ++k)
    if (all[k] > 0.0) share = std::max(share, pass[k] / all[k]);
  return share;
}

// Estimates what all passes after this one would add, as a share of all light. Passes shrink at least as fast
// as the last two did, so the rest is bounded by a geometric series.
double tailOf(const std::vector<double>& before, const std::vector<double>& now,
              const std::vector<double>& all) {
  double worst = 0.0;
  for (std::size_t k = 0; k < now.size(); ++k) {
    if (!(all[k] > 0.0)) continue;
    const double ratio = before[k] > 0.0 ? std::min(now[k] / before[k], 0.999) : 0.0;
    worst = std::max(worst, now[k] * ratio / (1.0 - ratio) / all[k]);
  }
  return worst;
}

}  // namespace

std::optional<BounceResult> bakeBounces(const DirectPass& pass, const DirectResult& direct,
                                        const DiffuseScene& scene, const BounceSettings& settings,
                                        const BakeContext& context, BouncePartner* partner) {
  const ExitRadiance exit(scene.geometry, scene.samples, partner);
  const Gather gather(pass, direct, scene);
  BounceResult result{
      .field = zeroLike(direct.field), .mapped = zeroLike(direct.mapped), .energy = {1.0}, .left_out = 0.0};
  const bool any_filled = std::find(direct.looks.valid.begin(), direct.looks.valid.end(), std::uint8_t{0}) !=
                          direct.looks.valid.end();
  const auto edges = any_filled ? sampleEdges(scene.geometry, scene.samples)
                                : std::vector<std::pair<std::uint32_t, std::uint32_t>>{};
  TransferField before = direct.field;
  const auto energiesOf = [&](const TransferField& field) {
    std::vector<double> sums = energies(field);
    if (!partner) return sums;
    const auto more = partner->energies();
    sums.insert(sums.end(), more.begin(), more.end());
    return sums;
  };
  std::vector<double> energy = energiesOf(before), all = energy;
  const std::vector<double> first = energy;
  const auto first_mapped = static_cast<std::ptrdiff_t>(scene.samples.first_normal_mapped);
  const int most = settings.bounces < 0 ? kMostBounces : settings.bounces;
  for (int number = 1; number <= most; ++number) {
    context.progress.begin(fmt::format("bounce {}", number), scene.samples.size(), "samples");
    TransferField now = zeroLike(before);
    const Bounce bounce{number, shareOf(energy, all) < kShareToThin, exit, before};
    const BakeContext pass_context = context.part("pass", number);
    // For normal-mapped samples, the sum of all passes so far is kept.
    const auto gathered =
        runStage({.count = scene.samples.first_glossy,
                  .grain = kSamplesGathered,
                  .writes = {rowsOf(now.vectors, now.vectorSize()),
                             rowsOf(result.mapped.vectors, result.mapped.vectorSize(), -first_mapped)},
                  .compute = [&](std::size_t begin,
                                 std::size_t end) { gather.range(bounce, begin, end, now, result.mapped); }},
                 pass_context);
    if (!gathered) return std::nullopt;
    if (any_filled) fillFromNeighbours(edges, direct.looks.valid, now);
    if (partner && !partner->gather(bounce, now, pass_context.part("glossy"))) return std::nullopt;
    add(now, result.field);

    const std::vector<double> energy_before = std::exchange(energy, energiesOf(now));
    double share = 0.0;
    for (std::size_t k = 0; k < energy.size(); ++k) {
      all[k] += energy[k];
      if (first[k] > 0.0) share = std::max(share, energy[k] / first[k]);
    }
    result.energy.push_back(share);
    result.left_out = tailOf(energy_before, energy, all);
    if (settings.bounces < 0 && result.left_out < settings.tail_error) break;
    before = std::move(now);
    if (partner) partner->advance();
  }
  if (any_filled)
    fillStretchFromNeighbours(edges, direct.looks.valid, scene.samples.first_normal_mapped,
                              result.mapped.vectorSize(), result.mapped.vectors);
  return result;
}

void dropBounces(const DiffuseScene& scene, std::size_t inside_faces, const BakeContext& context) {
  const std::size_t plain = scene.samples.first_glossy, glossy = scene.samples.size() - plain;
  for (int number = 1; number <= kMostBounces; ++number) {
    const BakeContext pass = context.part("pass", number);
    dropStage(pass, plain, kSamplesGathered);
    dropStage(pass.part("glossy"), glossy, kSamplesGathered);
    dropStage(pass.part("glossy").part("inside faces"), inside_faces, kSamplesGathered);
  }
}

}  // namespace lambent::baker
