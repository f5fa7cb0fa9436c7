#include "baker/bake/bake_group.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "baker/bake/bake_around.hpp"
#include "baker/bake/fit_vertices.hpp"
#include "baker/bake/group_keys.hpp"
#include "baker/bake/result_bytes.hpp"
#include "baker/brdf/kernel_power.hpp"
#include "baker/cache/cached_ranges.hpp"
#include "baker/effects/diffuse/bounces.hpp"
#include "baker/effects/diffuse/direct.hpp"
#include "baker/effects/diffuse/payloads.hpp"
#include "baker/effects/glossy/glossy_bounces.hpp"
#include "baker/effects/glossy/glossy_direct.hpp"
#include "baker/effects/glossy/inside_faces.hpp"
#include "baker/effects/glossy/payloads.hpp"
#include "baker/effects/neighborhood/surface_body.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/proxy/capture_proxy.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/sample_areas.hpp"

namespace lambent::baker {

namespace {

// What passes left out may amount to, as a share of the bound on the coding error.
constexpr double kTailShare = 0.3;

// Of the bound on glossy light, where light bounces: to halve the error costs visibility a dozen bytes a
// vertex, and bounced light of sharp metals a hundred (docs/decisions/compression.md, "Glossy matrices").
constexpr float kOfVisibility = 0.35f;

// What the runtime holds of a group's shaded samples lies in one page: a vec4 for each output of each sample,
// and an OpenGL driver may have pages of 128 MiB.
constexpr std::uint64_t kMostBytesShaded = std::uint64_t{128} << 20;
std::uint64_t bytesShaded(const SampleSet& samples, int glossy_order) {
  const std::uint64_t outputs =
      static_cast<std::uint64_t>(glossy_order) * static_cast<std::uint64_t>(glossy_order);
  return 16 * (samples.first_normal_mapped +
               bundle::kMappedOutputs * (samples.first_glossy - samples.first_normal_mapped) +
               outputs * (samples.size() - samples.first_glossy));
}

struct Transported {
  DirectResult direct;
  std::optional<GlossyDirect> glossy;  // where there are glossy samples
  std::optional<BounceResult> bounced;
  std::size_t inside_faces = 0;  // glossy samples at which bounces were gathered beside those of vertices
};

// What making it cost, and what it came to.
struct TransportFigures {
  GroupFigures of_group;
  std::uint64_t rays = 0, rays_kept = 0, glossy_rays = 0, glossy_rays_kept = 0;
  double ray_seconds = 0.0;
};

std::optional<Transported> transport(const DiffuseScene& scene, const SurfaceBrdfs* brdfs,
                                     const BakeOptions& options, const GroupKeys& keys, Cache* cache,
                                     Progress& progress, const std::stop_token& stop,
                                     TransportFigures& figures) {
  const bool bounces = options.bounces != 0, any_glossy = brdfs != nullptr;
  const std::size_t hit_memory = options.effectiveMemory() / (any_glossy ? 4 : 2);
  GroupFigures& group = figures.of_group;
  progress.begin("direct light", scene.samples.first_glossy, "samples");
  const DirectPass pass(scene, {.order = options.order,
                                .rays = options.effectiveRays(),
                                .keep_hits = bounces,
                                .hit_memory = hit_memory,
                                .colored_kernels = any_glossy && !brdfs->grey()});
  auto direct = bakeDirect(pass, scene, progress, stop, {cache, keys.rays});
  if (!direct) return std::nullopt;
  figures.ray_seconds += progress.now().seconds;
  figures.rays = direct->field.rays, figures.rays_kept = direct->rays_kept;
  group.filled_samples = direct->field.filled_samples;
  if (options.fitsDiffuse()) {
    const auto fit = fitDiffuse(pass, scene, *direct, progress, stop, {cache, keys.rays});
    if (!fit) return std::nullopt;
    figures.ray_seconds += fit->ray_seconds;
    figures.rays += fit->rays, figures.rays_kept += fit->rays_kept;
  }
  group.hit_bytes = direct->hits.bytes();
  Transported light{std::move(*direct), std::nullopt, std::nullopt};

  std::optional<GlossyPass> glossy_pass;
  if (any_glossy) {
    glossy_pass.emplace(pass, scene, options.exitOrder());
    progress.begin("glossy shadows", glossy_pass->size(), "samples");
    light.glossy = bakeGlossyDirect(*glossy_pass, hit_memory, light.direct.looks, progress, stop,
                                    {cache, keys.glossy_rays});
    if (!light.glossy) return std::nullopt;
    figures.ray_seconds += progress.now().seconds;
    figures.glossy_rays = light.glossy->rays, figures.glossy_rays_kept = light.glossy->rays_kept;
    group.filled_samples += light.glossy->filled_samples;
    if (options.fitsGlossy()) {
      const auto fit = fitGlossy(*glossy_pass, *light.glossy, progress, stop, {cache, keys.glossy_rays});
      if (!fit) return std::nullopt;
      figures.ray_seconds += fit->ray_seconds;
      figures.glossy_rays += fit->rays, figures.glossy_rays_kept += fit->rays_kept;
    }
    if (!diffuseFromGlossy(*glossy_pass, light.glossy->field, light.direct, stop)) return std::nullopt;
    const std::uint64_t inside = light.glossy->inside ? light.glossy->inside->hits().bytes() : 0;
    group.hit_bytes = std::max<std::uint64_t>(group.hit_bytes, light.glossy->hits.bytes() + inside);
    group.glossy_samples = light.glossy->field.size();
  }
  if (!bounces) return light;

  ExitKernels kernels;
  std::optional<GlossyBounces> partner;
  if (any_glossy) {
    kernels = {.grey = brdfs->grey(),
               .at = [brdfs](std::uint32_t triangle, float u, float v, const glm::vec3& to,
                             std::span<float> out) { brdfs->exitKernel(triangle, u, v, to, out); }};
    partner.emplace(*glossy_pass, kernels, light.direct, *light.glossy, options.glossy_order);
  }
  const double tail = kTailShare * double{options.effectiveErrorBound()};
  light.bounced = bakeBounces(pass, light.direct, scene, {options.bounces, tail}, progress, stop,
                              partner ? &*partner : nullptr, {cache, keys.bounces});
  if (!light.bounced) return std::nullopt;
  if (partner) {
    partner->finish();
    light.glossy->hits = HitStore();
    if (light.glossy->inside) light.inside_faces = light.glossy->inside->size();
    light.glossy->inside.reset();
  }
  light.direct.hits = HitStore();
  group.pass_energy = light.bounced->energy;
  group.left_out = light.bounced->left_out;
  return light;
}

// Visibility and bounced light are shown together: errors of both are relative to both, and their squares add
// up to that of the bound. A bound that was asked for is kept at any price.
std::vector<CodedTransfer> codeGlossy(const SampleCell& cell, const GlossyField& field,
                                      const BandPower& kernel_power, bool grey_emission,
                                      const BakeOptions& options, const std::stop_token& stop,
                                      CachedCoding& coding, GroupFigures& figures) {
  std::vector<CodedTransfer> coded;
  const std::vector<CellVectors> parts = glossyCellVectors(cell, field, grey_emission);
  double shown = 0.0;
  bool any_bounced = false;
  for (const CellVectors& part : parts) {
    if (part.shape.order == 0) continue;  // the group's lights
    shown += transferEnergy(part.vectors, part.shape, kernel_power);
    any_bounced |= !part.shape.isVisibility();
  }
  double square = 0.0;
  for (const CellVectors& part : parts) {
    const bool environment = part.shape.order > 0;
    float bound = options.effectiveGlossyErrorBound();
    if (environment && any_bounced)
      bound *= part.shape.isVisibility() ? kOfVisibility : std::sqrt(1.0f - kOfVisibility * kOfVisibility);
    coded.push_back(
        coding.code(part.vectors, cell.count, part.shape,
                    {.bound = bound,
                     .most_components = options.error_bound > 0.0f ? kAllComponents : kUsualComponents,
                     .loose_bound = options.glossyLooseness() * bound,
                     .shown_energy = environment ? shown : 0.0,
                     .kernel_power = kernel_power},
                    stop));
    const double error = coded.back().error;
    if (environment)
      square += error * error;
    else
      figures.worst_glossy_error = std::max(figures.worst_glossy_error, error);
  }
  figures.worst_glossy_error = std::max(figures.worst_glossy_error, std::sqrt(square));
  return coded;
}

std::vector<CodedTransfer> codeDiffuse(const SampleCell& cell, const SampleSet& samples,
                                       const Transported& light, bool grey_emission,
                                       const BakeOptions& options, const std::stop_token& stop,
                                       CachedCoding& coding, GroupFigures& figures) {
  std::vector<CodedTransfer> coded;
  for (const CellVectors& vectors :
       cellVectors(cell, samples, light.direct, light.bounced ? &*light.bounced : nullptr, grey_emission)) {
    coded.push_back(coding.code(vectors.vectors, cell.count, vectors.shape,
                                {.bound = options.effectiveErrorBound()}, stop));
    figures.worst_error = std::max(figures.worst_error, double{coded.back().error});
  }
  return coded;
}

// All that a group hands to the bundle of its transfer.
void keepCells(const Keep& keep, const std::vector<std::vector<CodedTransfer>>& cells,
               const TransportFigures& figures) {
  ByteWriter out;
  write(cells, out);
  write(figures.of_group, out);
  out.add(figures.rays + figures.rays_kept), out.add(figures.glossy_rays + figures.glossy_rays_kept);
  keep.cache->put(keep.key, out.bytes());
}

bool findCells(const Keep& keep, std::vector<std::vector<CodedTransfer>>& cells, TransportFigures& figures) {
  const auto bytes = keep.cache->find(keep.key);
  if (!bytes) return false;
  ByteReader in(*bytes);
  if (read(in, cells) && read(in, figures.of_group) && in.read(figures.rays_kept) &&
      in.read(figures.glossy_rays_kept) && in.atEnd())
    return true;
  cells.clear();
  figures = {};
  return false;
}

// What the report says of a group, and of what its effects cost.
void tell(const TransportFigures& figures, bool found, bool any_diffuse, bool any_glossy,
          BakeReport::Group& group, BakeReport& report) {
  const GroupFigures& g = figures.of_group;
  report.filled_samples += g.filled_samples;
  report.glossy_samples += g.glossy_samples;
  report.hit_bytes = std::max(report.hit_bytes, g.hit_bytes);
  report.worst_error = std::max(report.worst_error, g.worst_error);
  report.worst_glossy_error = std::max(report.worst_glossy_error, g.worst_glossy_error);
  report.left_out = std::max(report.left_out, g.left_out);
  if (g.pass_energy.size() > report.pass_energy.size()) report.pass_energy = g.pass_energy;
  report.ray_seconds += figures.ray_seconds;
  const auto add = [&](const char* name, std::uint64_t rays, std::uint64_t rays_kept) {
    const Reuse reuse = found ? Reuse::Found : rays > 0 || rays_kept == 0 ? Reuse::Baked : Reuse::Regathered;
    group.effects.push_back({name, reuse, rays, rays_kept});
    report.rays += rays, report.rays_kept += rays_kept;
  };
  if (any_diffuse) add("diffuse", figures.rays, figures.rays_kept);
  if (any_glossy) add("glossy", figures.glossy_rays, figures.glossy_rays_kept);
}

}  // namespace

std::size_t mostGlossySamples(int glossy_order) {
  return kMostBytesShaded /
         (16u * static_cast<std::size_t>(glossy_order) * static_cast<std::size_t>(glossy_order));
}

Result<BakedGroup> bakeGroup(const Scene& scene, const RigidGroup& group, LightProbeCount light_probes,
                             const PlannedNeighborhood& neighborhood, const BrdfTables& tables,
                             const ShippedMeshes& meshes,
                             const std::vector<std::shared_ptr<const AlphaMap>>& alpha_maps,
                             DecodedImages& images, const BakeOptions& options, Progress& progress,
                             const std::stop_token& stop, BakeReport& report, Cache* cache) {
  const auto stopped = [&] { return fail(scene.source.string(), "stopped; nothing was written"); };
  BakedGroup baked;
  progress.begin("samples");
  const auto place = [&](bool with_glossy) {
    baked.geometry = buildGroupGeometry(group, scene, meshes.decoded, with_glossy);
    baked.samples = buildSamples(baked.geometry);
  };
  place(!tables.entries.empty());
  if (const std::uint64_t bytes = bytesShaded(baked.samples, options.glossy_order);
      baked.samples.first_glossy < baked.samples.size() && bytes > kMostBytesShaded) {
    report.notices.push_back(fmt::format(
        "rigid group \"{}\": {} glossy samples take {} MiB on the GPU, more than the {} MiB that one piece "
        "may have; its "
        "surfaces are Lambert. Part it into several groups (extras.lambent.movable), or lower --glossy-order",
        group.name, baked.samples.size() - baked.samples.first_glossy, bytes >> 20, kMostBytesShaded >> 20));
    place(/*with_glossy=*/false);
  }
  baked.lights = findGroupLights(scene, group);
  report.vertices += baked.geometry.positions.size();
  report.triangles += baked.geometry.triangles.size();
  report.samples += baked.samples.size();
  report.lights += baked.lights.size();
  const GroupKeys keys =
      cache ? groupKeys(scene, baked.geometry, baked.lights, light_probes, options) : GroupKeys{};
  // Only what was not found asks for colours: pictures take long to decode.
  std::optional<SurfaceColors> colors;
  const auto needColors = [&]() -> Result<void> {
    if (colors) return {};
    auto loaded = SurfaceColors::load(scene, baked.geometry, baked.lights, images);
    if (!loaded) return failAgain(loaded.error());
    colors = std::move(*loaded);
    return {};
  };

  progress.begin("light samples");
  cachedValue(
      Keep{cache, keys.light_probes}, [&](ByteReader& in) { return read(in, baked.light_probes); },
      [&] {
        baked.light_probes =
            chooseLightProbes(baked.samples, sampleAreas(baked.geometry, baked.samples),
                              baked.geometry.bounds_min, baked.geometry.bounds_max, light_probes);
        return true;
      },
      [&](ByteWriter& out) { write(baked.light_probes, out); });
  progress.begin("proxy");
  Result<void> proxy_made;
  cachedValue(
      Keep{cache, keys.proxy}, [&](ByteReader& in) { return read(in, baked.proxy); },
      [&] {
        proxy_made = needColors();
        if (proxy_made) baked.proxy = makeCaptureProxy(baked.geometry, baked.samples, *colors);
        return proxy_made.has_value();
      },
      [&](ByteWriter& out) { write(baked.proxy, out); });
  if (!proxy_made) return failAgain(proxy_made.error());
  BakeReport::Group& figures = report.groups.emplace_back();
  figures.name = group.name;
  figures.light_probes = baked.light_probes.points.size();
  for (const bundle::ProxyLevel& level : baked.proxy.levels)
    figures.proxy_triangles.push_back(level.triangle_count);

  const bool any_glossy = baked.samples.first_glossy < baked.samples.size();
  const Around around{group.name, neighborhood, baked.geometry.origin, raysAroundSurfaces(options), options};
  // What the cells were coded from is what the body sends.
  const Keep around_keep = keepOf(around, cache, keys.cells);
  const Keep cells_keep{cache, keys.cells};
  TransportFigures work;
  const bool found = cache && findCells(cells_keep, baked.cells, work);
  if (found) tell(work, found, baked.samples.first_glossy > 0, any_glossy, figures, report);
  const bool any_around = neighborhood.baked && !baked.geometry.triangles.empty();
  const bool around_found = any_around && findAround(around, around_keep, report, baked.neighborhood);
  if (found && (!any_around || around_found)) return baked;

  if (auto loaded = needColors(); !loaded) return failAgain(loaded.error());
  progress.begin("hierarchy");
  auto rays = RayScene::build(baked.geometry, scene, alpha_maps);
  if (!rays) return failAgain(rays.error());
  const DiffuseScene view{scene, baked.geometry, baked.samples, *rays, *colors, baked.lights};
  std::optional<SurfaceBrdfs> brdfs;
  if (any_glossy) {
    auto loaded = SurfaceBrdfs::load(scene, baked.geometry, tables, images, options.exitOrder());
    if (!loaded) return failAgain(loaded.error());
    brdfs = std::move(*loaded);
  }
  work = {};
  const auto light = transport(view, brdfs ? &*brdfs : nullptr, options, keys, cache, progress, stop, work);
  if (!light) return stopped();

  if (!found) {
    progress.begin("coding", baked.samples.size(), "samples");
    const BandPower kernel_power =
        brdfs ? kernelPower(baked.geometry, *brdfs, options.glossy_order) : BandPower(kLobePower);
    CachedCoding coding(cache);
    for (const SampleCell& cell : baked.samples.cells) {
      const bool grey = colors->greyEmission();
      baked.cells.push_back(
          cell.kind == SampleKind::Glossy
              ? codeGlossy(cell, light->glossy->field, kernel_power, grey, options, stop, coding,
                           work.of_group)
              : codeDiffuse(cell, baked.samples, *light, grey, options, stop, coding, work.of_group));
      if (stop.stop_requested()) return stopped();
      progress.add(cell.count);
    }
    tell(work, found, baked.samples.first_glossy > 0, any_glossy, figures, report);
    if (cache) keepCells(cells_keep, baked.cells, work);
    coding.drop();
  } else {
    report.rays += work.rays + work.glossy_rays;
  }

  if (any_around && !around_found) {
    std::optional<SurfaceBrdfs> shown;
    if (brdfs) shown = brdfs->firstBands(options.glossy_order);
    const SurfaceBody body(view, {.direct = light->direct.field,
                                  .bounced = light->bounced ? &light->bounced->field : nullptr,
                                  .brdfs = shown ? &*shown : nullptr,
                                  .glossy = light->glossy ? &light->glossy->field : nullptr});
    const Box3 bounds{baked.geometry.bounds_min, baked.geometry.bounds_max};
    if (!bakeAround(around, body, bounds, progress, stop, around_keep, report, baked.neighborhood))
      return stopped();
  }
  if (cache && options.bounces != 0) dropBounces(view, light->inside_faces, {cache, keys.bounces});
  return baked;
}

}  // namespace lambent::baker
