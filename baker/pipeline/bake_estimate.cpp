#include "baker/pipeline/bake_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "baker/jobs/kept_value.hpp"
#include "runtime/base/memory.hpp"

namespace lambent::baker {

namespace {

// Of a rehearsal. Refinement with fewer probes stops too early in rooms.
constexpr std::size_t kRays = 128;
constexpr double kMostCodesBound = 0.1;
// Noise of rays takes bytes where codes keep it. With the square root of so many fewer rays as the bound on
// codes is wider, they keep as little; what is left of the difference was measured on the sample scenes.
constexpr double kBytesPower = 0.2;
// Hits of the points at which the error of pictures is measured take so many times what those of samples do.
constexpr double kHitsOfView = 6.0;

// Rays of each such point, of both looks (picture_error.cpp).
double raysOfView(const BakeOptions& options) {
  const auto rays = static_cast<double>(options.effectiveRays());
  return rays + std::max(2.0 * rays, std::clamp(8.0 * rays, 1024.0, 4096.0));
}

BakeOptions rehearsalOf(const BakeOptions& options, bool glossy) {
  BakeOptions few = options;
  few.rays = static_cast<std::uint32_t>(std::min(options.effectiveRays(), kRays));
  few.refine_bound = options.effectiveRefineBound();
  // A bound that is given is kept at any price where surfaces are glossy, which says little about the bake.
  if (glossy && options.error_bound == 0.0f) return few;
  const double fewer = static_cast<double>(options.effectiveRays()) / static_cast<double>(few.rays);
  few.error_bound =
      static_cast<float>(std::min(kMostCodesBound, double{options.effectiveErrorBound()} * std::sqrt(fewer)));
  return few;
}

// Returns stages whose seconds are those of processors.
std::vector<Progress::Stage> ofProcessors(std::span<const Progress::Stage> stages) {
  std::vector<Progress::Stage> out(stages.begin(), stages.end());
  for (Progress::Stage& stage : out) stage.seconds = stage.processor_seconds;
  return out;
}

// Estimates the bake from a rehearsal with few rays.
BakeEstimate estimateFrom(const BakeReport& report, const BakeOptions& few, const BakeOptions& options) {
  BakeEstimate estimate;
  const double times = static_cast<double>(options.effectiveRays()) / static_cast<double>(few.rays);
  const PartSeconds parts = scaleSeconds(report.stages, few, options);
  const PartSeconds of_processors = scaleSeconds(ofProcessors(report.stages), few, options);
  estimate.parts = parts;
  estimate.seconds = sumSeconds(parts);
  for (const auto& [stage, seconds] : stageSeconds(of_processors))
    estimate.processor_stages[stage] += seconds, estimate.processor_seconds += seconds;
  const double of_codes = std::pow(times, few.error_bound > 0.0f ? kBytesPower : 0.0);
  estimate.samples = static_cast<double>(report.samples);
  estimate.rays = static_cast<double>(report.rays) * times;
  estimate.bytes = static_cast<double>(report.file_bytes - report.transfer_bytes) +
                   static_cast<double>(report.transfer_bytes) * of_codes;
  double more_hits = 0.0;
  for (const BakeReport::Group& group : report.groups) {
    BakeEstimate::Group& of = estimate.groups.emplace_back();
    of.name = group.name;
    of.samples = static_cast<double>(group.samples);
    double rays = 0.0;
    for (const auto& effect : group.effects) rays += static_cast<double>(effect.rays);
    of.rays = rays * times;
    of.seconds = sumSeconds({parts[group.part]});
    of.processor_stages = of_processors[group.part];
    const double hits = std::min(static_cast<double>(group.hit_bytes) * times,
                                 0.5 * static_cast<double>(options.effectiveMemory()));
    const double of_view = group.picture_error && rays > 0.0
                               ? kHitsOfView * static_cast<double>(group.hit_bytes) / rays *
                                     static_cast<double>(group.picture_error->points) *
                                     (raysOfView(options) - raysOfView(few))
                               : 0.0;
    more_hits = std::max(more_hits, hits - static_cast<double>(group.hit_bytes) + of_view);
    of.hit_bytes = hits;
    of.memory_bytes = hits + of.samples * options.bytesOfTransfer(false);
    of.bytes = static_cast<double>(group.transfer_bytes) * of_codes;
  }
  estimate.memory_bytes = static_cast<double>(peakBytes()) + more_hits;
  return estimate;
}

Key keyOf(const Scene& scene, const BakeOptions& options) {
  KeyMaker key = KeyMaker::ofStage("estimate");
  key.add(sceneDigest(scene));
  for (const auto& [name, word] : options.settings()) key.addText(name).addText(word);
  return key.add(options.threads).add(options.memory_bytes).key();
}

}  // namespace

void write(const BakeEstimate& estimate, ByteWriter& out) {
  out.add(estimate.samples), out.add(estimate.rays), out.add(estimate.seconds);
  out.add(estimate.memory_bytes), out.add(estimate.bytes);
  writeSeconds(estimate.parts, out);
}

// The whole is kept, not its groups.
bool read(ByteReader& in, BakeEstimate& estimate) {
  return in.read(estimate.samples) && in.read(estimate.rays) && in.read(estimate.seconds) &&
         in.read(estimate.memory_bytes) && in.read(estimate.bytes) && readSeconds(in, estimate.parts);
}

Result<BakeEstimate> estimateBake(const Scene& scene, const BakeOptions& options,
                                  const BakeContext& context) {
  const auto plan = planFor(scene, options);
  if (!plan) return failAgain(plan.error());
  const BakeOptions few = rehearsalOf(options, plan->bakes("glossy"));
  Progress progress;
  const auto report = rehearse(scene, few, {progress, context.stop});
  if (!report) return failAgain(report.error());
  return estimateFrom(*report, few, options);
}

void keepEstimate(const Scene& scene, const BakeOptions& options, const BakeEstimate& estimate,
                  Cache& cache) {
  Progress unused;
  keepValue({unused, {}, &cache, keyOf(scene, options)}, estimate);
}

std::optional<BakeEstimate> findEstimate(const Scene& scene, const BakeOptions& options, Cache& cache) {
  Progress unused;
  BakeEstimate estimate;
  if (!findKept({unused, {}, &cache, keyOf(scene, options)}, estimate)) return std::nullopt;
  return estimate;
}

}  // namespace lambent::baker
