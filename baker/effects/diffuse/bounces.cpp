#include "baker/effects/diffuse/bounces.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "baker/compress/light_weights.hpp"
#include "baker/effects/diffuse/field_bytes.hpp"
#include "baker/effects/diffuse/fill.hpp"
#include "baker/transport/frame.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::baker {

namespace {

// Once a pass has less than this share of all light, its rays are thinned: their noise of a percent of a
// percent is not seen.
constexpr double kShareToThin = 0.01;

// Energy of a field for each source of light: the environment first, then each light of the group.
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
  Gather(const DirectPass& pass, const DirectResult& direct, const DiffuseScene& scene,
         const ExitRadiance& exit)
      : pass_(pass), direct_(direct), scene_(scene), exit_(exit) {}

  // Samples [begin, end) of bounce `bounce`. `mapped` gets it added; it is in the group's frame.
  void range(int bounce, bool thinly, std::size_t begin, std::size_t end, const TransferField& before,
             TransferField& now, TransferField& mapped) const {
    std::vector<GatherHit> thinned;
    const StoredHits hits(direct_.hits, pass_, begin, end);
    const std::size_t first_mapped = scene_.samples.first_normal_mapped;
    for (std::size_t s = begin; s < end; ++s) {
      auto own = hits.of(s);
      const Hemisphere& hemisphere = pass_.hemisphereOf(s, direct_.looks.double_rays[s] != 0);
      float scale = 1.0f;
      if (thinly) scale = thinHits(bounce, hemisphere, own, thinned);
      const ExitToSample exit(exit_, hemisphere.table(), scene_.samples.normals[s], s, bounce, thinly);
      if (s < first_mapped)
        gatherPlain(own, scale, hemisphere, exit, before, now.at(s));
      else
        gatherMapped(s, own, scale, hemisphere, exit, before, now.at(s), mapped.at(s - first_mapped));
    }
  }

 private:
  void gatherPlain(std::span<const GatherHit> hits, float scale, const Hemisphere& hemisphere,
                   const ExitToSample& exit, const TransferField& before, std::span<float> out) const {
    for (const GatherHit& hit : hits)
      exit.add(hit, scale * static_cast<float>(hemisphere.weight(hit.ray)), before, out);
  }

  void gatherMapped(std::size_t sample, std::span<const GatherHit> hits, float scale,
                    const Hemisphere& hemisphere, const ExitToSample& exit_to, const TransferField& before,
                    std::span<float> out, std::span<float> mapped) const {
    const std::size_t stride = before.vectorSize();
    std::vector<float> exit(stride), local(kIncident * stride, 0.0f);
    for (const GatherHit& hit : hits) {
      std::fill(exit.begin(), exit.end(), 0.0f);
      exit_to.add(hit, scale, before, exit);
      const auto weight = static_cast<float>(hemisphere.weight(hit.ray));
      for (std::size_t i = 0; i < stride; ++i) out[i] += weight * exit[i];
      const auto& weights = hemisphere.incidentWeight(hit.ray);
      for (std::size_t j = 0; j < kIncident; ++j)
        for (std::size_t i = 0; i < stride; ++i) local[j * stride + i] += weights[j] * exit[i];
    }
    if (hits.empty()) return;
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
  const ExitRadiance& exit_;
};

// The largest share that a pass has of all light, over the sources of light.
double shareOf(const std::vector<double>& pass, const std::vector<double>& all) {
  double share = 0.0;
  for (std::size_t k = 0; k < pass.size(); ++k)
    if (all[k] > 0.0) share = std::max(share, pass[k] / all[k]);
  return share;
}

// What all passes after this one would add, as a share of all light: the passes shrink at least as fast as
// the last two did, so the rest is a geometric series.
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
                                        Progress& progress, const std::stop_token& stop,
                                        BouncePartner* partner, const Keep& keep) {
  const ExitRadiance exit(scene.geometry, scene.samples, partner);
  const Gather gather(pass, direct, scene, exit);
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
  // In bytes to keep: the pass of plain samples, and of normal-mapped ones the sum of all passes so far.
  const std::size_t own = before.vectorSize(), of_mapped = result.mapped.vectorSize();
  const auto mappedOf = [&](std::size_t sample) {
    return std::max(sample, scene.samples.first_normal_mapped) - scene.samples.first_normal_mapped;
  };
  const int most = settings.bounces < 0 ? kMostBounces : settings.bounces;
  for (int bounce = 1; bounce <= most; ++bounce) {
    progress.begin(fmt::format("bounce {}", bounce), scene.samples.size(), "samples");
    TransferField now = zeroLike(before);
    const bool thinly = shareOf(energy, all) < kShareToThin;
    const Keep keep_pass = keep.part("pass", bounce);
    const CachedRanges kept =
        cachedRanges(keep_pass, scene.samples.first_glossy, kSamplesGathered, stop,
                     {.compute =
                          [&](std::size_t begin, std::size_t end) {
                            gather.range(bounce, thinly, begin, end, before, now, result.mapped);
                            progress.add(end - begin);
                          },
                      .pack =
                          [&](std::size_t begin, std::size_t end, ByteWriter& out) {
                            writeStretch(now.vectors, begin * own, end * own, out);
                            writeStretch(result.mapped.vectors, mappedOf(begin) * of_mapped,
                                         mappedOf(end) * of_mapped, out);
                          },
                      .unpack =
                          [&](std::size_t begin, std::size_t end, ByteReader& in) {
                            progress.add(end - begin);
                            return readStretch(in, begin * own, end * own, now.vectors) &&
                                   readStretch(in, mappedOf(begin) * of_mapped, mappedOf(end) * of_mapped,
                                               result.mapped.vectors);
                          }},
                     KeepWhen::Due);
    if (!kept.finished) return std::nullopt;
    if (any_filled) fillFromNeighbours(edges, direct.looks.valid, now);
    if (partner &&
        !partner->gather(bounce, thinly, exit, before, now, progress, stop, keep_pass.part("glossy")))
      return std::nullopt;
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

void dropBounces(const DiffuseScene& scene, std::size_t inside_faces, const Keep& keep) {
  const std::size_t plain = scene.samples.first_glossy, glossy = scene.samples.size() - plain;
  for (int bounce = 1; bounce <= kMostBounces; ++bounce) {
    const Keep pass = keep.part("pass", bounce);
    dropRanges(pass, plain, kSamplesGathered);
    dropRanges(pass.part("glossy"), glossy, kSamplesGathered);
    dropRanges(pass.part("glossy").part("inside faces"), inside_faces, kSamplesGathered);
  }
}

}  // namespace lambent::baker
