#include "baker/bake/bake.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "baker/bake/bake_group.hpp"
#include "baker/bake/group_scene.hpp"
#include "baker/bake/options.hpp"
#include "baker/bake/ship_meshes.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/effects/surface/bounces.hpp"
#include "baker/effects/volume/volume.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/refine/refine.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/bundle/container.hpp"

namespace lambent::baker {

namespace {

// Writes the bundle and completes the report.
Result<BakeReport> writeBundle(AssembledBundle bundle, const std::filesystem::path& output,
                               const BakeContext& context, BakeReport report) {
  // What cannot be opened must not take the place of a bundle that can.
  const auto opens = [](const std::filesystem::path& part) -> Result<void> {
    if (const auto reader = bundle::Reader::open(part); !reader) return failAgain(reader.error());
    return {};
  };
  if (auto written = bundle::write(output, std::move(bundle.description), bundle.blobs, opens); !written)
    return failAgain(written.error());
  context.progress.end();
  std::error_code ignored;
  report.file_bytes = std::filesystem::file_size(output, ignored);
  report.stages = context.progress.finished();
  if (const Cache* cache = context.cache) {
    report.cache = cache->figures();
    if (std::string notice = cache->notice(); !notice.empty()) report.notices.push_back(std::move(notice));
  }
  return report;
}

// Checks the request and calls work() with as many threads as it asks for.
template <typename Work>
Result<BakeReport> checkedBake(const Scene& scene, const BakeOptions& options,
                               const std::filesystem::path& output, const Work& work) {
  if (auto checked = checkRequest(options, output); !checked) return failAgain(checked.error());
  std::error_code ignored;
  if (std::filesystem::equivalent(scene.source, output, ignored))
    return fail(output.string(), "is the scene itself", "name another file for the bundle");
  std::optional<Result<BakeReport>> result;
  withThreads(options.threads, [&] { result = work(); });
  return std::move(*result);
}

constexpr float kY00 = 0.282094792f;
// The coding bound for a single vector, where a looser one would save next to nothing.
constexpr float kBound = 1e-5f;
// Outputs of up to so many bands are stored as they are, those of more bands as visibility.
constexpr std::uint32_t kDenseBands = 3;

// Returns the transfer of a place that sees everything: with one output the mean of the light, else the light
// itself.
CodedTransfer openTransfer(int order, std::uint32_t outputs) {
  transfer::TransferShape shape;
  shape.order = static_cast<std::uint32_t>(order);
  shape.outputs = outputs;
  const bool as_visibility = outputs > kDenseBands * kDenseBands;
  if (as_visibility) shape.visibility_bands = shape.order + transfer::bandsOf(outputs) - 1;
  std::vector<float> vector(shape.size(), 0.0f);
  if (as_visibility)
    vector[0] = std::sqrt(4.0f * std::numbers::pi_v<float>);  // V = 1
  else if (outputs == 1)
    vector[0] = kY00;
  else
    for (std::uint32_t j = 0; j < std::min(outputs, shape.columns()); ++j)
      vector[j * shape.columns() + j] = 1.0f;
  return codeTransfer(vector, 1, shape, {.bound = kBound});
}

// Making BRDF tables takes longer than all else here, so glossy surfaces are diffuse until they exist.
BakedGroup openSurfaces(const Scene& scene, const RigidGroup& group, const ShippedMeshes& meshes,
                        const BakeOptions& options) {
  BakedGroup baked;
  baked.geometry = buildGroupGeometry(group, scene, meshes.decoded, /*with_glossy=*/false);
  // A cell with one sample in the middle belongs to no vertex: it says how many bands of light the group
  // takes.
  const glm::vec3 center = 0.5f * (baked.geometry.bounds_min + baked.geometry.bounds_max);
  baked.light_probes.points = {center};
  baked.light_probes.cells.push_back({{0}, {}});
  baked.samples.positions.push_back(center);
  baked.samples.cells.push_back({0, 1, center, center, SampleKind::Diffuse});
  baked.surfaces.cells.push_back({openTransfer(options.order, 1)});
  baked.surfaces.figures.codes_bound = options.effectiveErrorBound();
  baked.samples.vertex_sample.assign(baked.geometry.positions.size(), kNoSample);
  return baked;
}

// The transfer of the volume is one voxel that fills its box.
BakedGroup openVolume(const Scene& scene, const RigidGroup& group, const BakeOptions& options) {
  const SceneVolume& volume = scene.volumes[static_cast<std::size_t>(group.volume)];
  BakedGroup baked;
  baked.volume = placeVolume(scene, group, quantizeDensity(volume.density));
  baked.light_probes.points = {baked.volume->light_probe};
  const auto bands = static_cast<std::uint32_t>(bandsOfPhase(volume.g, options.order));
  CodedCell& cell = baked.volume->cells.emplace_back();
  cell.count = 1;
  cell.bounds_min = cell.bounds_max = baked.volume->light_probe;
  cell.transfers.push_back(openTransfer(options.order, bands * bands));
  baked.volume->voxels = {0};
  return baked;
}

Result<BakeReport> bakeUnshadowedOnTheseThreads(const Scene& scene, const BakeOptions& options,
                                                const std::filesystem::path& output,
                                                const BakeContext& context) {
  BakeReport report;
  context.progress.begin("plan");
  const auto plan = planFor(scene, options);
  if (!plan) return failAgain(plan.error());
  const BrdfTables tables;
  auto split = splitMeshes(scene, plan->groups, options.max_edge_m);
  if (!split) return failAgain(split.error());
  auto meshes = shipMeshes(scene, plan->groups, std::move(*split), context);
  if (!meshes) return failAgain(meshes.error());

  context.progress.begin("writing");
  std::vector<BakedGroup> baked;
  for (const RigidGroup& group : plan->groups) {
    baked.push_back(group.volume >= 0 ? openVolume(scene, group, options)
                                      : openSurfaces(scene, group, *meshes, options));
    report.vertices += baked.back().geometry.positions.size();
    report.triangles += baked.back().geometry.triangles.size();
  }
  const SceneBake whole{scene, options, *plan, tables};
  AssembledBundle bundle = assemble(whole, std::move(*meshes), baked, report);
  bundle.description.generator.settings["transfer"] = "none";
  if (context.stopped()) return whole.stopped();
  return writeBundle(std::move(bundle), output, context, std::move(report));
}

}  // namespace

Result<BakeReport> bakeUnshadowed(const Scene& scene, const BakeOptions& options,
                                  const std::filesystem::path& output, const BakeContext& context) {
  return checkedBake(scene, options, output,
                     [&] { return bakeUnshadowedOnTheseThreads(scene, options, output, context); });
}

template <>
inline constexpr auto kKeptMembers<bundle::BrdfTable> =
    std::tuple(&bundle::BrdfTable::order, &bundle::BrdfTable::lobes, &bundle::BrdfTable::angles,
               &bundle::BrdfTable::azimuths, &bundle::BrdfTable::roughnesses, &bundle::BrdfTable::strengths,
               &bundle::BrdfTable::values);
template <>
inline constexpr auto kKeptMembers<BrdfTables::Entry> = std::tuple(&BrdfTables::Entry::family,
                                                                   &BrdfTables::Entry::name,
                                                                   &BrdfTables::Entry::table);
template <>
inline constexpr auto kKeptMembers<BrdfTables> = std::tuple(&BrdfTables::of_material, &BrdfTables::entries);

namespace {

static_assert(BakeOptions::kMostBounces == kMostBounces);
constexpr int kMostGlossyOrder = 6;
constexpr int kMostNeighborhoodOrder = 6;
// The second look of refinement has so many times the rays of the first.
constexpr std::size_t kTimesFirstRays = 4;

Result<BrdfTables> brdfTablesOf(const Scene& scene, const BakeOptions& options, const BakeContext& context) {
  context.progress.begin("BRDF tables");
  const int order = options.exitOrder(), shipped = options.glossy_order;
  Result<BrdfTables> tables;
  findOrMake(context.keyed(context.cache ? brdfTablesKey(scene, order, shipped) : Key{}), *tables, [&] {
    tables = BrdfTables::make(scene, order, shipped);
    return tables.has_value();
  });
  return tables;
}

// Returns the meshes as they ship: edges are split where the options and shadows ask for it, then meshes are
// coded.
Result<ShippedMeshes> meshesOf(const SceneBake& bake, DecodedImages& images, const BakeContext& context,
                               RefineReport& refinement) {
  const auto& [scene, options, plan, tables] = bake;
  auto split = splitMeshes(scene, plan.groups, options.max_edge_m);
  if (!split) return failAgain(split.error());
  const bool with_glossy = !tables.entries.empty();
  if (const float bound = options.effectiveRefineBound(); bound > 0.0f) {
    const std::size_t rays = std::min(RefineOptions{}.rays, options.effectiveRays());
    RefineOptions refine{.bound = bound,
                         .rays = rays,
                         .many_rays = kTimesFirstRays * rays,
                         .glossy = options.refinesGlossy(),
                         .most_growth = options.refineGrowth(),
                         .most_added = options.refineAdded()};
    if (with_glossy) refine.most_vertices = mostGlossySamples(options.glossy_order);
    auto refined =
        refineMeshes({scene, plan.groups, plan.transport, with_glossy, images}, refine, *split, context);
    if (!refined) return failAgain(refined.error());
    refinement = *refined;
  }
  return shipMeshes(scene, plan.groups, std::move(*split), context);
}

Result<BakeReport> bakeOnTheseThreads(const Scene& scene, const BakeOptions& options,
                                      const std::filesystem::path& output, const BakeContext& context) {
  context.progress.begin("plan");
  const auto plan = planFor(scene, options);
  if (!plan) return failAgain(plan.error());
  DecodedImages images(scene);
  Result<BrdfTables> tables;
  if (plan->bakes("glossy")) tables = brdfTablesOf(scene, options, context);
  if (!tables) return failAgain(tables.error());

  const SceneBake whole{scene, options, *plan, *tables};
  BakeReport report;
  context.progress.beginPart();
  auto meshes = meshesOf(whole, images, context, report.refinement);
  if (!meshes) return failAgain(meshes.error());
  std::vector<BakedGroup> groups;
  for (std::size_t g = 0; g < plan->groups.size(); ++g) {
    context.progress.beginPart();
    auto group = plan->groups[g].volume >= 0 ? bakeVolume(whole, images, g, groups, context, report)
                                             : bakeGroup(whole, {*meshes, images}, g, context, report);
    if (!group) return failAgain(group.error());
    groups.push_back(std::move(*group));
  }
  if (context.stopped()) return whole.stopped();
  context.progress.beginPart();
  context.progress.begin("writing");
  AssembledBundle bundle = assemble(whole, std::move(*meshes), groups, report);
  return writeBundle(std::move(bundle), output, context, std::move(report));
}

// No neighborhoods are baked with so many bands: one that the user asked for is an error, others are left
// out.
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
  // The file is opened as for writing; closing it uncommitted leaves nothing behind.
  if (const auto writable = AtomicFile::open(output); !writable) return failAgain(writable.error());
  return {};
}

Result<EffectPlan> planFor(const Scene& scene, const BakeOptions& options) {
  const auto effects = effectsNamed(options.effects);
  if (!effects) return failAgain(effects.error());
  EffectPlan plan = makePlan(scene, *effects, options.leavesNothingOut());
  if (plan.bakes("glossy") && options.order > kMostGlossyOrder)
    return fail("--order", fmt::format("{} is more than glossy surfaces take", options.order),
                fmt::format("use at most {}, or --effects diffuse", kMostGlossyOrder));
  if (plan.bakes("neighborhood") && options.order > kMostNeighborhoodOrder)
    if (Result<void> left = leaveNeighborhoods(plan, options.order); !left) return failAgain(left.error());
  // Groups of volumes come last; without the volume effect they are removed.
  if (!plan.bakes("volume"))
    while (!plan.groups.empty() && plan.groups.back().volume >= 0)
      plan.groups.pop_back(), plan.light_probes.pop_back(), plan.neighborhoods.pop_back(),
          plan.transport.pop_back();
  if (options.leavesNothingOut())
    for (PlannedTransport& planned : plan.transport) planned.shadows = planned.bounces = true;
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
                        const BakeContext& context) {
  return checkedBake(scene, options, output, [&] {
    if (context.cache) context.cache->beginBake();
    return bakeOnTheseThreads(scene, options, output, context);
  });
}

}  // namespace lambent::baker
