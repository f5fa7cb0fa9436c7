#include "baker/effects/diffuse/bounces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "baker/compress/light_weights.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/trace/fill.hpp"
#include "baker/trace/patch_light.hpp"
#include "baker/trace/patches.hpp"
#include "baker/transport/frame.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::baker {

namespace {

// Once a pass has less than this share of all light, its rays are thinned: their noise, a percent of at most
// a percent, is not visible.
constexpr double kShareToThin = 0.01;

// Adds the squares of a vector under real lights to a sum for each source of light: the environment first,
// then each light of the group.
void addSquares(std::span<const float> vector, std::size_t columns, std::size_t bands, double weight,
                std::vector<double>& sums) {
  for (std::size_t at = 0; at < vector.size(); ++at) {
    const std::size_t column = at % columns;
    const double square = weight * double{vector[at]} * double{vector[at]};
    if (column < bands)
      sums[0] += kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(column)))] * square;
    else
      sums[1 + column - bands] += square;
  }
}

// Returns RMS over samples of what a field has, for each source of light.
std::vector<double> energies(const TransferField& field) {
  const auto bands = static_cast<std::size_t>(sh::coefficientCount(field.order));
  std::vector<double> sums(1 + field.columns - bands, 0.0);
  const std::size_t samples = field.size();
  for (std::size_t s = 0; s < samples; ++s) addSquares(field.at(s), field.columns, bands, 1.0, sums);
  for (double& sum : sums)
    sum = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(samples * field.channels, 1)));
  return sums;
}

void add(const TransferField& part, TransferField& sum) {
  for (std::size_t i = 0; i < sum.vectors.size(); ++i) sum.vectors[i] += part.vectors[i];
}

class Gather {
 public:
  Gather(const DirectPass& pass, const DirectResult& direct, const TracedScene& scene,
         const ExitRadiance& exit)
      : pass_(pass), direct_(direct), scene_(scene), exit_(exit) {}

  void visitHits(std::size_t sample, const TakeHit& take) const {
    const Hemisphere& hemisphere = pass_.hemisphereOf(sample, direct_.looks.double_rays[sample] != 0);
    const StoredHits hits(direct_.hits, pass_, sample, sample + 1);
    const glm::mat3 frame(localFrame(glm::normalize(glm::dvec3(scene_.samples.normals[sample]))));
    for (const GatherHit& hit : hits.of(sample))
      take(hit, static_cast<float>(hemisphere.weight(hit.ray)),
           exit_.albedo(hit, -(frame * hemisphere.direction(hit.ray))));
  }

  // Gathers at samples [begin, end). Adds to `mapped`, which is in the group's frame.
  void range(const Bounce& bounce, std::size_t begin, std::size_t end, TransferField& now,
             TransferField& mapped) const {
    std::vector<GatherHit> thinned;
    const StoredHits hits(direct_.hits, pass_, begin, end);
    const std::size_t first_mapped = scene_.samples.normal_mapped.begin;
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
  const TracedScene& scene_;
  const ExitRadiance& exit_;
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

// Returns RMS over samples of what patches have, for each source of light, as energies() does.
std::vector<double> energies(const PatchRadiance& radiance) {
  const TransferField& field = radiance.field;
  const auto bands = static_cast<std::size_t>(sh::coefficientCount(field.order));
  std::vector<double> sums(1 + field.columns - bands, 0.0);
  for (std::size_t patch = 0; patch < field.size(); ++patch) {
    const auto members =
        static_cast<double>(radiance.patches.offsets[patch + 1] - radiance.patches.offsets[patch]);
    addSquares(field.at(patch), field.columns, bands, members, sums);
  }
  const std::size_t samples = std::max<std::size_t>(radiance.patches.samples.size(), 1);
  for (double& sum : sums) sum = std::sqrt(sum / static_cast<double>(samples * field.channels));
  return sums;
}

// Tells how much light each pass brought, and when the rest is not worth another.
class Tally {
 public:
  explicit Tally(std::vector<double> first) : first_(first), now_(first), all_(std::move(first)) {}

  void add(std::vector<double> energy, BounceResult& result) {
    const std::vector<double> before = std::exchange(now_, std::move(energy));
    double share = 0.0;
    for (std::size_t k = 0; k < now_.size(); ++k) {
      all_[k] += now_[k];
      if (first_[k] > 0.0) share = std::max(share, now_[k] / first_[k]);
    }
    result.energy.push_back(share);
    result.left_out = tailOf(before, now_, all_);
  }
  const std::vector<double>& now() const { return now_; }
  const std::vector<double>& all() const { return all_; }

 private:
  std::vector<double> first_, now_, all_;
};

// Returns how bright samples are under all lights at once, for patches.
std::vector<float> brightnessOf(const TransferField& direct, const TransferField& bounced) {
  const auto bands = static_cast<std::size_t>(sh::coefficientCount(direct.order));
  std::vector<float> brightness(direct.size(), 0.0f);
  for (std::size_t s = 0; s < brightness.size(); ++s)
    for (const TransferField* field : {&direct, &bounced}) {
      const auto vector = field->at(s);
      for (std::size_t at = 0; at < vector.size(); ++at)
        if (const std::size_t column = at % field->columns; column == 0 || column >= bands)
          brightness[s] += std::abs(vector[at]);
    }
  return brightness;
}

// Adds what patches have to all of their samples.
void add(const PatchRadiance& rest, TransferField& field) {
  for (std::size_t s = 0; s < field.size(); ++s) {
    const auto from = rest.field.at(rest.patches.of_sample[s]);
    const auto to = field.at(s);
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
  }
}

}  // namespace

std::optional<BounceResult> bakeBounces(const DirectPass& pass, const DirectResult& direct,
                                        const TracedScene& scene, const BounceSettings& settings,
                                        const BakeContext& context, BouncePartner* partner) {
  const ExitRadiance exit(scene.geometry, scene.samples, partner);
  const Gather gather(pass, direct, scene, exit);
  BounceResult result{.field = direct.field.zeros(direct.field.size()),
                      .mapped = direct.mapped.zeros(direct.mapped.size()),
                      .energy = {1.0},
                      .left_out = 0.0};
  const bool any_filled = std::find(direct.looks.valid.begin(), direct.looks.valid.end(), std::uint8_t{0}) !=
                          direct.looks.valid.end();
  const auto edges = any_filled ? sampleEdges(scene.geometry, scene.samples)
                                : std::vector<std::pair<std::uint32_t, std::uint32_t>>{};
  const auto withPartner = [&](std::vector<double> sums) {
    if (!partner) return sums;
    const auto more = partner->energies();
    sums.insert(sums.end(), more.begin(), more.end());
    return sums;
  };
  const auto first_mapped = static_cast<std::ptrdiff_t>(scene.samples.normal_mapped.begin);
  // Adds what arrives at samples to the result, and returns it.
  const auto gatherAll = [&](const Bounce& bounce) -> std::optional<TransferField> {
    context.progress.begin(fmt::format("bounce {}", bounce.number), scene.samples.size(), "samples");
    TransferField now = direct.field.zeros(direct.field.size());
    const BakeContext own = context.part("pass", bounce.number);
    // Of normal-mapped samples the sum of all passes so far is kept.
    const auto gathered =
        runStage({.count = scene.samples.glossy.begin,
                  .grain = kSamplesGathered,
                  .writes = {rowsOf(now.vectors, now.vectorSize()),
                             rowsOf(result.mapped.vectors, result.mapped.vectorSize(), -first_mapped)},
                  .compute = [&](std::size_t begin,
                                 std::size_t end) { gather.range(bounce, begin, end, now, result.mapped); }},
                 own);
    if (!gathered) return std::nullopt;
    if (any_filled) fillFromNeighbours(edges, direct.looks.valid, now);
    if (partner && !partner->gather(bounce, now, own.part("glossy"))) return std::nullopt;
    add(now, result.field);
    return now;
  };

  const int most = settings.bounces < 0 ? kMostBounces : settings.bounces;
  Tally tally(withPartner(energies(direct.field)));
  const auto enough = [&](int number) {
    return number == most || (settings.bounces < 0 && result.left_out < settings.tail_error);
  };
  auto passed_on = gatherAll({.number = 1, .thinly = false, .exit = exit, .before = direct.field});
  if (!passed_on) return std::nullopt;
  tally.add(withPartner(energies(*passed_on)), result);
  if (!enough(1)) {
    if (partner) partner->advance();
    const Patches patches = choosePatches(scene.geometry, scene.samples,
                                          brightnessOf(direct.field, *passed_on), direct.looks.valid, edges);
    PatchTransport transport(patches, exit.triangleSamples(), direct.field.channels);
    const auto visit = [&](std::size_t sample, const TakeHit& take) {
      if (sample < scene.samples.glossy.begin) return gather.visitHits(sample, take);
      partner->visitHits(sample, [&](const GatherHit& hit, float weight, const glm::vec3& to) {
        take(hit, weight, exit.albedo(hit, to));
      });
    };
    if (!transport.build(visit, context)) return std::nullopt;
    const std::vector<double> first = tally.now();
    PatchRadiance last{patches, transport.meansOf(*passed_on)},
        rest{patches, passed_on->zeros(patches.size())};
    const std::vector<double> first_of_patches = energies(last);
    std::vector<double> gathered_last = first;  // energy of all that the last pass gathers
    for (int number = 2;; ++number) {
      last.field = transport.bounce(last.field);
      const std::vector<double> of_patches = energies(last);
      std::vector<double> energy = first;
      for (std::size_t k = 0; k < energy.size(); ++k) {
        const std::size_t source = k % of_patches.size();
        energy[k] *= first_of_patches[source] > 0.0 ? of_patches[source] / first_of_patches[source] : 0.0;
      }
      tally.add(energy, result);
      if (enough(number)) break;
      for (std::size_t k = 0; k < energy.size(); ++k) gathered_last[k] += energy[k];
      add(last.field, rest.field);
    }
    add(rest, *passed_on);
    const double share = shareOf(gathered_last, tally.all());
    if (!gatherAll({.number = 2,
                    .thinly = share < kShareToThin,
                    .exit = exit,
                    .before = *passed_on,
                    .of_patches = &rest,
                    .growth = shareOf(gathered_last, first)}))
      return std::nullopt;
  }
  if (any_filled)
    fillStretchFromNeighbours(edges, direct.looks.valid, scene.samples.normal_mapped.begin,
                              result.mapped.vectorSize(), result.mapped.vectors);
  return result;
}

void dropBounces(const TracedScene& scene, std::size_t inside_faces, const BakeContext& context) {
  const std::size_t plain = scene.samples.glossy.begin, glossy = scene.samples.glossy.size();
  for (const int number : {1, 2}) {
    const BakeContext pass = context.part("pass", number);
    dropStage(pass, plain, kSamplesGathered);
    dropStage(pass.part("glossy"), glossy, kSamplesGathered);
    dropStage(pass.part("glossy").part("inside faces"), inside_faces, kSamplesGathered);
  }
}

}  // namespace lambent::baker
