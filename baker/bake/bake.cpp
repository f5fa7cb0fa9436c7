#include "baker/bake/bake.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "baker/bake/assemble.hpp"
#include "baker/bake/bake_group.hpp"
#include "baker/bake/bake_volume.hpp"
#include "baker/bake/group_keys.hpp"
#include "baker/bake/option_rows.hpp"
#include "baker/bake/result_bytes.hpp"
#include "baker/bake/ship_meshes.hpp"
#include "baker/cache/cached_ranges.hpp"
#include "baker/effects/diffuse/bounces.hpp"
#include "baker/effects/effect_list.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/refine/refine.hpp"
#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {

namespace {

static_assert(BakeOptions::kMostBounces == kMostBounces);
constexpr int kMostGlossyOrder = 6;
constexpr int kMostNeighborhoodOrder = 6;

// All effects that the scene calls for, or those that the user listed.
Result<std::vector<EffectEntry>> effectsOf(const BakeOptions& options) {
  const auto all = effectList();
  std::vector<EffectEntry> chosen;
  if (options.effects == "auto") return std::vector<EffectEntry>(all.begin(), all.end());
  for (std::size_t begin = 0; begin <= options.effects.size();) {
    const std::size_t end = std::min(options.effects.find(',', begin), options.effects.size());
    const std::string name = options.effects.substr(begin, end - begin);
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const EffectEntry& e) { return name == e.name; });
    if (found == all.end()) {
      std::string known;
      for (const EffectEntry& entry : all)
        known += fmt::format("{}{}", known.empty() ? "" : ", ", entry.name);
      return fail("--effects", fmt::format("\"{}\" is not an effect", name),
                  "use auto or a list of: " + known);
    }
    chosen.push_back(*found);
    begin = end + 1;
  }
  return chosen;
}

Result<BrdfTables> cachedBrdfTables(const Scene& scene, const BakeOptions& options, Cache* cache) {
  Result<BrdfTables> tables;
  const int order = options.exitOrder(), shipped = options.glossy_order;
  const Keep keep{cache, cache ? brdfTablesKey(scene, order, shipped) : Key{}};
  cachedValue(
      keep, [&](ByteReader& in) { return read(in, *tables); },
      [&] {
        tables = BrdfTables::make(scene, order, shipped);
        return tables.has_value();
      },
      [&](ByteWriter& out) { write(*tables, out); });
  return tables;
}

tl::unexpected<Error> stopped(const Scene& scene) {
  return fail(scene.source.string(), "stopped; nothing was written");
}

Result<BakeReport> bakeOnTheseThreads(const Scene& scene, const BakeOptions& options,
                                      const std::filesystem::path& output, Progress& progress,
                                      const std::stop_token& stop, Cache* cache) {
  BakeReport report;
  progress.begin("plan");
  const auto plan = planFor(scene, options);
  if (!plan) return failAgain(plan.error());
  DecodedImages images(scene);
  const auto alpha_maps = loadAlphaMaps(scene, images);
  if (!alpha_maps) return failAgain(alpha_maps.error());

  BrdfTables tables;
  if (plan->bakes("glossy")) {
    progress.begin("BRDF tables");
    auto made = cachedBrdfTables(scene, options, cache);
    if (!made) return failAgain(made.error());
    tables = std::move(*made);
  }

  auto split = splitMeshes(scene, plan->groups, options.max_edge_m);
  if (!split) return failAgain(split.error());
  if (const float bound = options.effectiveRefineBound(); bound > 0.0f) {
    RefineOptions refine{.bound = bound,
                         .most_growth = options.refineGrowth(),
                         .most_added = options.refineAdded(),
                         .most_wedges = options.refineWedges()};
    if (!tables.entries.empty()) refine.most_vertices = mostGlossySamples(options.glossy_order);
    auto refined = refineMeshes(scene, plan->groups, *alpha_maps, !tables.entries.empty(), refine, *split,
                                progress, stop, cache);
    if (!refined) return failAgain(refined.error());
    report.refinement = *refined;
  }
  auto meshes = shipMeshes(scene, plan->groups, *split, progress, stop, cache);
  if (!meshes) return failAgain(meshes.error());

  std::vector<BakedGroup> baked;
  for (std::size_t g = 0; g < plan->groups.size(); ++g) {
    auto result =
        plan->groups[g].volume >= 0
            ? bakeVolume(scene, plan->groups, g, baked, *alpha_maps, plan->neighborhoods[g], options,
                         progress, stop, report, cache)
            : bakeGroup(scene, plan->groups[g], plan->light_probes[g].count, plan->neighborhoods[g], tables,
                        *meshes, *alpha_maps, images, options, progress, stop, report, cache);
    if (!result) return failAgain(result.error());
    baked.push_back(std::move(*result));
  }
  if (stop.stop_requested()) return stopped(scene);

  progress.begin("writing");
  AssembledBundle bundle =
      assemble(scene, options, *plan, tables, std::move(*meshes), std::move(baked), report);
  if (auto written = bundle::write(output, std::move(bundle.description), bundle.blobs); !written)
    return failAgain(written.error());
  progress.end();
  std::error_code ignored;
  report.file_bytes = std::filesystem::file_size(output, ignored);
  report.stages = progress.finished();
  if (cache) {
    report.cache = cache->figures();
    if (std::string notice = cache->notice(); !notice.empty()) report.notices.push_back(std::move(notice));
  }
  return report;
}

// Of so many bands none are baked: those that nobody asked for are left out, those asked for an error.
Result<void> leaveNeighborhoods(EffectPlan& plan, int order) {
  const std::string reason = fmt::format("{} bands of light are more than its matrices take", order);
  for (PlannedNeighborhood& planned : plan.neighborhoods) {
    if (!planned.baked) continue;
    if (planned.asked)
      return fail(
          "--order", fmt::format("{} is more than neighborhoods take", order),
          fmt::format("use at most {}, or leave neighborhood out of --effects", kMostNeighborhoodOrder));
    planned.baked = false;
    planned.reason = reason;
  }
  for (EffectChoice& choice : plan.effects)
    if (choice.effect == "neighborhood") choice = {choice.effect, false, reason};
  return {};
}

}  // namespace

const char* reuseName(Reuse reuse) {
  switch (reuse) {
    case Reuse::Baked:
      return "baked";
    case Reuse::Regathered:
      return "re-gathered";
    case Reuse::Found:
      break;
  }
  return "found";
}

Result<void> checkRequest(const BakeOptions& options, const std::filesystem::path& output) {
  if (auto checked = checkOptions(options); !checked) return checked;
  if (const auto effects = effectsOf(options); !effects) return failAgain(effects.error());
  // Opened as it will be for writing; closing it uncommitted leaves nothing.
  if (const auto writable = AtomicFile::open(output); !writable) return failAgain(writable.error());
  return {};
}

Result<EffectPlan> planFor(const Scene& scene, const BakeOptions& options) {
  const auto effects = effectsOf(options);
  if (!effects) return failAgain(effects.error());
  EffectPlan plan = makePlan(scene, *effects);
  if (plan.bakes("glossy") && options.order > kMostGlossyOrder)
    return fail("--order", fmt::format("{} is more than glossy surfaces take", options.order),
                fmt::format("use at most {}, or --effects diffuse", kMostGlossyOrder));
  if (plan.bakes("neighborhood") && options.order > kMostNeighborhoodOrder)
    if (Result<void> left = leaveNeighborhoods(plan, options.order); !left) return failAgain(left.error());
  // Volumes come last; without their effect they are not there.
  if (!plan.bakes("volume"))
    while (!plan.groups.empty() && plan.groups.back().volume >= 0)
      plan.groups.pop_back(), plan.light_probes.pop_back(), plan.neighborhoods.pop_back();
  for (const RigidGroup& group : plan.groups)
    if (group.volume >= 0)
      if (auto checked = checkVolume(scene, scene.volumes[static_cast<std::size_t>(group.volume)], options);
          !checked)
        return failAgain(checked.error());
  if (options.light_probes > 0)
    for (PlannedLightProbes& planned : plan.light_probes)
      planned = {{static_cast<std::uint32_t>(options.light_probes), /*of_group=*/false}, "asked for"};
  return plan;
}

Result<BakeReport> bake(const Scene& scene, const BakeOptions& options, const std::filesystem::path& output,
                        Progress& progress, std::stop_token stop, Cache* cache) {
  if (auto checked = checkRequest(options, output); !checked) return failAgain(checked.error());
  std::error_code ignored;
  if (std::filesystem::equivalent(scene.source, output, ignored))
    return fail(output.string(), "is the scene itself", "name another file for the bundle");
  std::optional<Result<BakeReport>> result;
  if (cache) cache->beginBake();
  withThreads(options.threads,
              [&] { result = bakeOnTheseThreads(scene, options, output, progress, stop, cache); });
  return std::move(*result);
}

}  // namespace lambent::baker
