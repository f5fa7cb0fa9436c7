#include "baker/effects/surface/bounces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "baker/compress/cpca.hpp"
#include "baker/effects/surface/gather.hpp"
#include "baker/effects/surface/inside_faces.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/trace/patches.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::baker {

namespace {

// Once a pass has less than this share of all light, its rays are thinned: their noise, a percent of at most
// a percent, is not visible.
constexpr double kShareToThin = 0.01;

// Patches pass light on until this share of the tail error is left out: their passes cost next to nothing.
constexpr double kShareOfTail = 0.1;

// Patches reflect alike in all directions, which surfaces that are not diffuse do not. Light is passed on
// between patches once this is all, as a share of all light, that they can get wrong.
constexpr double kMostOff = 0.05;

// Light that is less than this share of the mean over all regions is too dark to see; what passes add there
// is measured against it.
constexpr double kDark = 0.05;

// Adds the squares of a vector under real lights to a sum for each source of light: the environment first,
// then each light of the group.
void addSquares(std::span<const float> vector, std::size_t columns, std::size_t bands, double weight,
                std::span<double> sums) {
  for (std::size_t at = 0; at < vector.size(); ++at) {
    const std::size_t column = at % columns;
    const double square = weight * double{vector[at]} * double{vector[at]};
    if (column < bands)
      sums[0] += kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(column)))] * square;
    else
      sums[1 + column - bands] += square;
  }
}

// Says how much of each region that eyes see consists of an item: a sample, or a patch.
struct SeenItem {
  std::uint32_t item = 0, region = 0;
  float share = 0.0f;  // those of a region sum to 1
};

// Returns RMS over what eyes see of what a field has, by region, and then by source of light.
struct Energies {
  std::size_t sources = 1;
  std::vector<double> values;

  Energies(const TransferField& field, std::span<const SeenItem> seen, std::size_t regions) {
    const auto bands = static_cast<std::size_t>(sh::coefficientCount(field.order));
    sources = 1 + field.columns - bands;
    values.assign(sources * regions, 0.0);
    for (const auto& [item, region, share] : seen)
      addSquares(field.at(item), field.columns, bands, double{share},
                 std::span(values).subspan(region * sources, sources));
    for (double& value : values) value = std::sqrt(value / static_cast<double>(field.channels));
  }
  // Returns the values, none of which is dark beside the mean of its source.
  std::vector<double> lit() const {
    std::vector<double> mean(sources, 0.0), lit = values;
    for (std::size_t k = 0; k < values.size(); ++k)
      mean[k % sources] += values[k] * static_cast<double>(sources) / static_cast<double>(values.size());
    for (std::size_t k = 0; k < lit.size(); ++k) lit[k] = std::max(lit[k], kDark * mean[k % sources]);
    return lit;
  }
};

void add(const TransferField& part, TransferField& sum) {
  for (std::size_t i = 0; i < sum.vectors.size(); ++i) sum.vectors[i] += part.vectors[i];
}

// Returns the largest share of all light that a pass has, over regions and light sources.
double shareOf(const Energies& pass, const Energies& all) {
  const std::vector<double> lit = all.lit();
  double share = 0.0;
  for (std::size_t k = 0; k < lit.size(); ++k)
    if (lit[k] > 0.0) share = std::max(share, pass.values[k] / lit[k]);
  return share;
}

// Estimates what all passes after this one would add, as a share of all light, where that is most. Passes
// shrink at least as fast as the last two did, so the rest is bounded by a geometric series.
double tailOf(const Energies& before, const Energies& now, const Energies& all) {
  const std::vector<double> lit = all.lit();
  double worst = 0.0;
  for (std::size_t k = 0; k < lit.size(); ++k) {
    if (!(lit[k] > 0.0)) continue;
    const double ratio = before.values[k] > 0.0 ? std::min(now.values[k] / before.values[k], 0.999) : 0.0;
    worst = std::max(worst, now.values[k] * ratio / (1.0 - ratio) / lit[k]);
  }
  return worst;
}

// Keeps account of how much light each pass brought, and of when the rest is not worth another.
class Tally {
 public:
  explicit Tally(Energies first) : first_(first), now_(first), all_(std::move(first)) {}

  void add(Energies energy, BounceResult& result) {
    const Energies before = std::exchange(now_, std::move(energy));
    for (std::size_t k = 0; k < now_.values.size(); ++k) all_.values[k] += now_.values[k];
    result.energy.push_back(shareOf(now_, first_));
    result.left_out = tailOf(before, now_, all_);
  }
  const Energies& now() const { return now_; }
  const Energies& all() const { return all_; }

 private:
  Energies first_, now_, all_;
};

// Returns how bright samples are under all lights at once.
std::vector<float> brightnessOf(const TransferField& field) {
  const auto bands = static_cast<std::size_t>(sh::coefficientCount(field.order));
  std::vector<float> brightness(field.size(), 0.0f);
  for (std::size_t s = 0; s < brightness.size(); ++s) {
    const auto vector = field.at(s);
    for (std::size_t at = 0; at < vector.size(); ++at)
      if (const std::size_t column = at % field.columns; column == 0 || column >= bands)
        brightness[s] += std::max(vector[at], 0.0f);
  }
  return brightness;
}

// Adds what patches have to all of their samples.
void add(const PatchRadiance& rest, TransferField& field) {
  for (std::size_t s = 0; s < field.size(); ++s) {
    const auto from = rest.field.at(rest.patches.of_sample[s]);
    const auto to = field.at(s);
    const float profile = rest.patches.profile[s];
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += profile * from[i];
  }
}

// All passes of one group.
class Passes {
 public:
  // Everything must outlive it.
  Passes(const LightToBounce& light, const BounceSettings& settings, const BakeContext& context)
      : light_(light),
        direct_(light.direct),
        scene_(light.pass.scene()),
        settings_(settings),
        context_(context),
        exit_(scene_.geometry, scene_.samples, startGlossy()),
        gather_(light.pass, direct_, exit_),
        seen_(seenSamples(scene_)),
        tally_(energiesOf(direct_.field)) {
    for (TracedPoints* const points : light.watched) points->bounced = direct_.field.zeros(points->size());
    result_.field = direct_.field.zeros(direct_.field.size());
    result_.mapped = direct_.mapped.zeros(direct_.mapped.size());
    if (const InsideFaces* const inside = light.inside(SurfacePart::Matte))
      mapped_inside_ = direct_.mapped.zeros(inside->points().direct.mapped.size());
    const auto& valid = direct_.looks.valid;
    if (std::ranges::find(valid, std::uint8_t{0}) != valid.end())
      edges_ = sampleEdges(scene_.geometry, scene_.samples);
  }

  std::optional<BounceResult> run() {
    auto brought = gather(1, direct_.field);
    if (!brought || (!enough(1, settings_.tail_error) && !goOn(std::move(*brought)))) return std::nullopt;
    fillFromNeighbours(edges_, direct_.looks.valid, scene_.samples.normal_mapped.begin,
                       result_.mapped.vectorSize(), result_.mapped.vectors);
    if (const InsideFaces* const inside = light_.inside(SurfacePart::Matte);
        inside &&
        !inside->fit(SampleKind::NormalMapped, mapped_inside_.vectors, result_.mapped.vectors, context_.stop))
      return std::nullopt;
    if (glossy_) glossy_->finish();
    return std::move(result_);
  }

 private:
  const GlossyExit* startGlossy() {
    if (!light_.kernels) return nullptr;
    return &glossy_.emplace(light_, settings_.order_out).exit();
  }
  std::size_t regions() const { return scene_.importance ? scene_.importance->region_count : 1; }
  // Without importance, all samples count alike in one region.
  static std::vector<SeenItem> seenSamples(const TracedScene& scene) {
    std::vector<SeenItem> seen;
    const std::size_t count = scene.samples.size();
    if (!scene.importance) {
      for (std::uint32_t s = 0; s < count; ++s) seen.push_back({s, 0, 1.0f / static_cast<float>(count)});
      return seen;
    }
    const SampleImportance& importance = *scene.importance;
    std::vector<double> sums(importance.region_count, 0.0);
    for (std::uint32_t s = 0; s < count; ++s) sums[importance.regions[s]] += double{importance.shares[s]};
    for (std::uint32_t s = 0; s < count; ++s)
      if (const double sum = sums[importance.regions[s]]; importance.shares[s] > 0.0f && sum > 0.0)
        seen.push_back({s, importance.regions[s], static_cast<float>(double{importance.shares[s]} / sum)});
    return seen;
  }
  Energies energiesOf(const TransferField& field) const { return {field, seen_, regions()}; }
  // Returns what the samples of patches count.
  std::vector<SeenItem> seenPatches(const Patches& patches) const {
    std::vector<SeenItem> seen;
    for (const SeenItem& sample : seen_)
      seen.push_back({patches.of_sample[sample.item], sample.region, sample.share});
    std::ranges::sort(seen, {}, [](const SeenItem& item) { return std::pair(item.item, item.region); });
    std::size_t last = 0;
    for (std::size_t i = 1; i < seen.size(); ++i) {
      if (seen[i].item == seen[last].item && seen[i].region == seen[last].region)
        seen[last].share += seen[i].share;
      else
        seen[++last] = seen[i];
    }
    seen.resize(std::min(seen.size(), last + 1));
    return seen;
  }
  bool enough(int passes, double tail_error) const {
    return passes == (settings_.bounces < 0 ? kMostBounces : settings_.bounces) ||
           (settings_.bounces < 0 && result_.left_out < tail_error);
  }

  // Gathers one pass of what the pass before brought. Returns what it brought, or nothing if stopped.
  std::optional<TransferField> gather(int number, const TransferField& before) {
    auto brought = gather({.number = number,
                           .thinly = shareOf(tally_.now(), tally_.all()) < kShareToThin,
                           .exit = exit_,
                           .before = before});
    if (brought) tally_.add(energiesOf(*brought), result_);
    return brought;
  }

  // Adds what arrives at samples to the result, and returns it. Returns nothing if stopped.
  std::optional<TransferField> gather(const Bounce& bounce) {
    context_.progress.begin(fmt::format("bounce {}", bounce.number), scene_.samples.size(), "samples");
    TransferField now = direct_.field.zeros(direct_.field.size());
    const BakeContext own = context_.part("pass", bounce.number);
    if (!gatherMatte(gather_, scene_.samples, bounce, now, result_.mapped, own)) return std::nullopt;
    fillFromNeighbours(edges_, direct_.looks.valid, 0, now.vectorSize(), now.vectors);
    if (!fit(bounce, own.part("inside faces"), now) || !watch(bounce)) return std::nullopt;
    if (glossy_ && !glossy_->gather(bounce, edges_, now, own.part("glossy"))) return std::nullopt;
    add(now, result_.field);
    return now;
  }

  // Gathers at all matte samples of a set. For normal-mapped ones, the sum of all passes so far is kept.
  static bool gatherMatte(const BounceGather& gather, const SampleSet& samples, const Bounce& bounce,
                          TransferField& now, TransferField& mapped, const BakeContext& context) {
    const auto first_mapped = static_cast<std::ptrdiff_t>(samples.normal_mapped.begin);
    return runStage({.count = samples.glossy.begin,
                     .grain = kSamplesGathered,
                     .writes = {rowsOf(now.vectors, now.vectorSize()),
                                rowsOf(mapped.vectors, mapped.vectorSize(), -first_mapped)},
                     .compute = [&](std::size_t begin,
                                    std::size_t end) { gather.matte(bounce, begin, end, now, mapped); }},
                    context)
        .has_value();
  }

  // Fits what a pass brought to vertices to what it brings to points inside faces. Returns false if stopped.
  bool fit(const Bounce& bounce, const BakeContext& context, TransferField& now) {
    const InsideFaces* const inside = light_.inside(SurfacePart::Matte);
    if (!inside) return true;
    const TracedPoints& points = inside->points();
    context_.progress.begin(fmt::format("bounce {} inside faces", bounce.number), points.size(), "samples");
    TransferField there = now.zeros(points.size());
    return gatherMatte({points.pass(), points.direct, exit_}, points.points().samples, bounce, there,
                       mapped_inside_, context) &&
           inside->fit(there, std::numeric_limits<float>::max(), now, context_.stop);
  }

  // Adds what a pass brings to the watched points, with all of their rays. Returns false if stopped.
  bool watch(const Bounce& bounce) {
    Bounce whole = bounce;
    whole.thinly = false;
    TransferField no_mapped;
    for (TracedPoints* const points : light_.watched)
      if (!gatherMatte({points->pass(), points->direct, exit_}, points->points().samples, whole,
                       points->bounced, no_mapped, context_.keyed(Key{})))
        return false;
    return true;
  }

  // Adds all passes after the first, which brought `first`. Returns false if stopped.
  bool goOn(TransferField first) {
    const auto visit = [&](std::size_t sample, const TakeHit& take) { gather_.visitHits(sample, take); };
    const auto samples_of = [this](const GatherHit& hit) { return exit_.samplesOf(hit); };
    const auto met = samplesMet(sampleAreas(scene_.geometry, scene_.samples), samples_of, visit, context_);
    if (!met) return false;
    const std::vector<float> bounced = brightnessOf(first);
    std::vector<float> brightness = brightnessOf(direct_.field);
    for (std::size_t s = 0; s < brightness.size(); ++s) brightness[s] += bounced[s];
    const Patches patches = choosePatches(
        scene_.samples, glm::distance(scene_.geometry.bounds_min, scene_.geometry.bounds_max),
        {.brightness = brightness, .bounced = bounced, .weights = *met, .valid = direct_.looks.valid},
        edges_);
    PatchTransport transport(patches, samples_of, direct_.field.channels);
    if (!transport.build(visit, context_)) return false;
    const double off = glossy_ ? offBy(transport, patches, first) : 0.0;
    TransferField brought = std::move(first);
    for (int number = 1;; ++number) {
      if (glossy_) glossy_->advance();
      if (off * result_.left_out <= kMostOff)
        return byPatches(transport, patches, number, std::move(brought));
      auto next = gather(number + 1, brought);
      if (!next) return false;
      if (enough(number + 1, settings_.tail_error)) return true;
      brought = std::move(*next);
    }
  }

  // Returns how far the first bounce between patches is off from what samples gathered: they reflect alike in
  // all directions. It is RMS over patches, relative, of the light source for which it is most.
  double offBy(const PatchTransport& transport, const Patches& patches, const TransferField& first) const {
    const std::vector<SeenItem> seen = seenPatches(patches);
    const TransferField gathered = transport.meansOf(first);
    TransferField off = transport.bounce(transport.meansOf(direct_.field));
    for (std::size_t i = 0; i < off.vectors.size(); ++i) off.vectors[i] -= gathered.vectors[i];
    return shareOf({off, seen, regions()}, {gathered, seen, regions()});
  }

  // Passes on between patches what pass `passes` brought, and gathers all of it at samples at last. Returns
  // false if stopped.
  bool byPatches(const PatchTransport& transport, const Patches& patches, int passes, TransferField first) {
    PatchRadiance last{patches, transport.meansOf(first)}, rest{patches, first.zeros(patches.size())};
    const std::vector<SeenItem> seen = seenPatches(patches);
    const Energies of_first = tally_.now(), of_first_patches{last.field, seen, regions()};
    Energies gathered = of_first;  // energy of all that is gathered at last
    for (int number = passes + 1;; ++number) {
      last.field = transport.bounce(last.field);
      const Energies of_patches{last.field, seen, regions()};
      Energies energy = of_first;
      for (std::size_t k = 0; k < energy.values.size(); ++k)
        energy.values[k] *=
            of_first_patches.values[k] > 0.0 ? of_patches.values[k] / of_first_patches.values[k] : 0.0;
      tally_.add(energy, result_);
      if (enough(number, kShareOfTail * settings_.tail_error)) break;
      for (std::size_t k = 0; k < energy.values.size(); ++k) gathered.values[k] += energy.values[k];
      add(last.field, rest.field);
    }
    add(rest, first);
    return gather({.number = passes + 1,
                   .thinly = shareOf(gathered, tally_.all()) < kShareToThin,
                   .exit = exit_,
                   .before = first,
                   .of_patches = &rest,
                   .growth = shareOf(gathered, of_first)})
        .has_value();
  }

  const LightToBounce& light_;
  const DirectResult& direct_;
  const TracedScene& scene_;
  const BounceSettings& settings_;
  const BakeContext& context_;
  std::optional<GlossyPasses> glossy_;  // set if there are glossy surfaces
  ExitRadiance exit_;
  BounceGather gather_;
  std::vector<SeenItem> seen_;
  Tally tally_;
  TransferField mapped_inside_;  // the sum of what all passes brought to normal-mapped points inside faces
  BounceResult result_{.field = {}, .mapped = {}, .energy = {1.0}, .left_out = 0.0};
  SampleEdges edges_;  // empty unless samples are filled
};

}  // namespace

std::optional<BounceResult> bakeBounces(const LightToBounce& light, const BounceSettings& settings,
                                        const BakeContext& context) {
  return Passes(light, settings, context).run();
}

void dropBounces(const SampleSet& samples, const std::array<std::size_t, 2>& inside,
                 const BakeContext& context) {
  for (int number = 1; number <= kMostBounces; ++number) {
    const BakeContext pass = context.part("pass", number);
    for (const SurfacePart part : {SurfacePart::Matte, SurfacePart::Glossy}) {
      const BakeContext own = part == SurfacePart::Glossy ? pass.part("glossy") : pass;
      dropStage(own, stretchOf(samples, part).size(), kSamplesGathered);
      dropStage(own.part("inside faces"), inside[static_cast<std::size_t>(part)], kSamplesGathered);
    }
  }
}

}  // namespace lambent::baker
