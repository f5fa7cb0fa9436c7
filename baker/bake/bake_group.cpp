#include "baker/bake/bake_group.hpp"

#include <algorithm>
#include <optional>

#include "baker/effects/diffuse/bounces.hpp"
#include "baker/effects/diffuse/direct.hpp"
#include "baker/effects/diffuse/payloads.hpp"
#include "baker/proxy/capture_proxy.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/sample_areas.hpp"
#include "baker/work/parallel.hpp"

namespace lambent::baker {

namespace {

// What passes left out may amount to, as a share of the bound on the coding error.
constexpr double kTailShare = 0.3;

struct Transported {
  DirectResult direct;
  std::optional<BounceResult> bounced;
};

std::optional<Transported> transport(const DiffuseScene& scene, const BakeOptions& options,
                                     Progress& progress, const std::stop_token& stop, BakeReport& report) {
  const bool bounces = options.bounces != 0;
  progress.begin("direct light", scene.samples.size(), "samples");
  const DirectPass pass(scene, {.order = options.order,
                                .rays = options.effectiveRays(),
                                .keep_hits = bounces,
                                .hit_memory = options.effectiveMemory() / 2});
  auto direct = bakeDirect(pass, scene, progress, stop);
  if (!direct) return std::nullopt;
  report.ray_seconds += progress.now().seconds;
  report.rays += direct->field.rays;
  report.filled_samples += direct->field.filled_samples;
  report.hit_bytes = std::max<std::uint64_t>(report.hit_bytes, direct->hits.bytes());
  if (!bounces) return Transported{std::move(*direct), std::nullopt};

  const double tail = kTailShare * double{options.effectiveErrorBound()};
  auto bounced = bakeBounces(pass, *direct, scene, {options.bounces, tail}, progress, stop);
  if (!bounced) return std::nullopt;
  direct->hits = HitStore();
  if (bounced->energy.size() > report.pass_energy.size()) report.pass_energy = bounced->energy;
  report.left_out = std::max(report.left_out, bounced->left_out);
  return Transported{std::move(*direct), std::move(bounced)};
}

}  // namespace

Result<BakedGroup> bakeGroup(const Scene& scene, const RigidGroup& group, LightSampleCount light_samples,
                             const ShippedMeshes& meshes,
                             const std::vector<std::shared_ptr<const AlphaMap>>& alpha_maps,
                             DecodedImages& images, const BakeOptions& options, Progress& progress,
                             const std::stop_token& stop, BakeReport& report) {
  const auto stopped = [&] { return fail(scene.source.string(), "stopped; nothing was written"); };
  BakedGroup baked;
  progress.begin("samples");
  baked.geometry = buildGroupGeometry(group, scene, meshes.decoded);
  baked.samples = buildSamples(baked.geometry);
  baked.lights = findGroupLights(scene, group);
  auto colors = SurfaceColors::load(scene, baked.geometry, baked.lights, images);
  if (!colors) return failAgain(colors.error());
  report.vertices += baked.geometry.positions.size();
  report.triangles += baked.geometry.triangles.size();
  report.samples += baked.samples.size();
  report.lights += baked.lights.size();

  progress.begin("light samples");
  baked.light_samples =
      chooseLightSamples(baked.samples, sampleAreas(baked.geometry, baked.samples), baked.geometry.bounds_min,
                         baked.geometry.bounds_max, light_samples);
  progress.begin("proxy");
  baked.proxy = makeCaptureProxy(baked.geometry, baked.samples, *colors);
  BakeReport::Group& figures = report.groups.emplace_back();
  figures.name = group.name;
  figures.light_samples = baked.light_samples.points.size();
  for (const bundle::ProxyLevel& level : baked.proxy.levels)
    figures.proxy_triangles.push_back(level.triangle_count);

  progress.begin("hierarchy");
  auto rays = RayScene::build(baked.geometry, scene, alpha_maps);
  if (!rays) return failAgain(rays.error());

  const DiffuseScene view{scene, baked.geometry, baked.samples, *rays, *colors, baked.lights};
  const auto light = transport(view, options, progress, stop, report);
  if (!light) return stopped();

  progress.begin("coding", baked.samples.size(), "samples");
  const CodingSettings coding{.bound = options.effectiveErrorBound()};
  for (const SampleCell& cell : baked.samples.cells) {
    auto& coded = baked.cells.emplace_back();
    for (const CellVectors& vectors :
         cellVectors(cell, baked.samples, light->direct, light->bounced ? &*light->bounced : nullptr,
                     colors->greyEmission()))
      coded.push_back(codeTransfer(vectors.vectors, cell.count, vectors.shape, coding, stop));
    if (stop.stop_requested()) return stopped();
    for (const CodedTransfer& transfer : coded)
      report.worst_error = std::max(report.worst_error, double{transfer.error});
    progress.add(cell.count);
  }
  return baked;
}

}  // namespace lambent::baker
