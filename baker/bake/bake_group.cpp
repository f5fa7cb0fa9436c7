#include "baker/bake/bake_group.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "baker/bake/bake_around.hpp"
#include "baker/brdf/kernel_power.hpp"
#include "baker/effects/diffuse/bounces.hpp"
#include "baker/effects/diffuse/direct.hpp"
#include "baker/effects/diffuse/payloads.hpp"
#include "baker/effects/glossy/glossy_bounces.hpp"
#include "baker/effects/glossy/glossy_direct.hpp"
#include "baker/effects/glossy/payloads.hpp"
#include "baker/effects/neighborhood/surface_body.hpp"
#include "baker/proxy/capture_proxy.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/sample_areas.hpp"
#include "baker/work/parallel.hpp"

namespace lambent::baker {

namespace {

// What passes left out may amount to, as a share of the bound on the coding error.
constexpr double kTailShare = 0.3;

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
};

// Rays and what they took, of a stage that has just ended.
void countRays(std::uint64_t rays, std::uint32_t filled, const HitStore& hits, const Progress& progress,
               BakeReport& report) {
  report.ray_seconds += progress.now().seconds;
  report.rays += rays;
  report.filled_samples += filled;
  report.hit_bytes = std::max<std::uint64_t>(report.hit_bytes, hits.bytes());
}

std::optional<Transported> transport(const DiffuseScene& scene, const SurfaceBrdfs* brdfs,
                                     const BakeOptions& options, Progress& progress,
                                     const std::stop_token& stop, BakeReport& report) {
  const bool bounces = options.bounces != 0, any_glossy = brdfs != nullptr;
  const std::size_t hit_memory = options.effectiveMemory() / (any_glossy ? 4 : 2);
  progress.begin("direct light", scene.samples.first_glossy, "samples");
  const DirectPass pass(scene, {.order = options.order,
                                .rays = options.effectiveRays(),
                                .keep_hits = bounces,
                                .hit_memory = hit_memory,
                                .colored_kernels = any_glossy && !brdfs->grey()});
  auto direct = bakeDirect(pass, scene, progress, stop);
  if (!direct) return std::nullopt;
  countRays(direct->field.rays, direct->field.filled_samples, direct->hits, progress, report);
  Transported light{std::move(*direct), std::nullopt, std::nullopt};

  std::optional<GlossyPass> glossy_pass;
  if (any_glossy) {
    glossy_pass.emplace(pass, scene, options.glossy_order);
    light.glossy = bakeGlossyDirect(*glossy_pass, hit_memory, light.direct, progress, stop);
    if (!light.glossy) return std::nullopt;
    countRays(light.glossy->rays, light.glossy->filled_samples, light.glossy->hits, progress, report);
    report.glossy_samples += light.glossy->field.size();
  }
  if (!bounces) return light;

  ExitKernels kernels;
  std::optional<GlossyBounces> partner;
  if (any_glossy) {
    kernels = {.grey = brdfs->grey(),
               .at = [brdfs](std::uint32_t triangle, float u, float v, const glm::vec3& to,
                             std::span<float> out) { brdfs->exitKernel(triangle, u, v, to, out); }};
    partner.emplace(*glossy_pass, kernels, light.direct, *light.glossy);
  }
  const double tail = kTailShare * double{options.effectiveErrorBound()};
  light.bounced = bakeBounces(pass, light.direct, scene, {options.bounces, tail}, progress, stop,
                              partner ? &*partner : nullptr);
  if (!light.bounced) return std::nullopt;
  if (partner) {
    partner->finish();
    light.glossy->hits = HitStore();
  }
  light.direct.hits = HitStore();
  if (light.bounced->energy.size() > report.pass_energy.size()) report.pass_energy = light.bounced->energy;
  report.left_out = std::max(report.left_out, light.bounced->left_out);
  return light;
}

// Visibility and bounced light are shown together: errors of both are relative to both, and each may have as
// much.
std::vector<CodedTransfer> codeGlossy(const SampleCell& cell, const GlossyField& field,
                                      const BandPower& kernel_power, bool grey_emission,
                                      const BakeOptions& options, const std::stop_token& stop,
                                      BakeReport& report) {
  std::vector<CodedTransfer> coded;
  const std::vector<CellVectors> parts = glossyCellVectors(cell, field, grey_emission);
  double shown = 0.0;
  std::size_t shown_parts = 0;
  for (const CellVectors& part : parts)
    if (part.shape.order > 0) shown += transferEnergy(part.vectors, part.shape, kernel_power), ++shown_parts;
  double square = 0.0;
  for (const CellVectors& part : parts) {
    const bool environment = part.shape.order > 0;
    const float bound = options.effectiveGlossyErrorBound() /
                        (environment ? std::sqrt(static_cast<float>(shown_parts)) : 1.0f);
    coded.push_back(codeTransfer(
        part.vectors, cell.count, part.shape,
        {.bound = bound, .shown_energy = environment ? shown : 0.0, .kernel_power = kernel_power}, stop));
    const double error = coded.back().error;
    if (environment)
      square += error * error;
    else
      report.worst_glossy_error = std::max(report.worst_glossy_error, error);
  }
  report.worst_glossy_error = std::max(report.worst_glossy_error, std::sqrt(square));
  return coded;
}

std::vector<CodedTransfer> codeDiffuse(const SampleCell& cell, const SampleSet& samples,
                                       const Transported& light, bool grey_emission,
                                       const BakeOptions& options, const std::stop_token& stop,
                                       BakeReport& report) {
  std::vector<CodedTransfer> coded;
  for (const CellVectors& vectors :
       cellVectors(cell, samples, light.direct, light.bounced ? &*light.bounced : nullptr, grey_emission)) {
    coded.push_back(codeTransfer(vectors.vectors, cell.count, vectors.shape,
                                 {.bound = options.effectiveErrorBound()}, stop));
    report.worst_error = std::max(report.worst_error, double{coded.back().error});
  }
  return coded;
}

}  // namespace

std::size_t mostGlossySamples(int glossy_order) {
  return kMostBytesShaded /
         (16u * static_cast<std::size_t>(glossy_order) * static_cast<std::size_t>(glossy_order));
}

Result<BakedGroup> bakeGroup(const Scene& scene, const RigidGroup& group, LightSampleCount light_samples,
                             const PlannedNeighborhood& neighborhood, const BrdfTables& tables,
                             const ShippedMeshes& meshes,
                             const std::vector<std::shared_ptr<const AlphaMap>>& alpha_maps,
                             DecodedImages& images, const BakeOptions& options, Progress& progress,
                             const std::stop_token& stop, BakeReport& report) {
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
  std::optional<SurfaceBrdfs> brdfs;
  if (baked.samples.first_glossy < baked.samples.size()) {
    auto loaded = SurfaceBrdfs::load(scene, baked.geometry, tables, images, options.glossy_order);
    if (!loaded) return failAgain(loaded.error());
    brdfs = std::move(*loaded);
  }
  const auto light = transport(view, brdfs ? &*brdfs : nullptr, options, progress, stop, report);
  if (!light) return stopped();

  progress.begin("coding", baked.samples.size(), "samples");
  const BandPower kernel_power =
      brdfs ? kernelPower(baked.geometry, *brdfs, options.glossy_order) : BandPower(kLobePower);
  for (const SampleCell& cell : baked.samples.cells) {
    const bool grey = colors->greyEmission();
    baked.cells.push_back(
        cell.kind == SampleKind::Glossy
            ? codeGlossy(cell, light->glossy->field, kernel_power, grey, options, stop, report)
            : codeDiffuse(cell, baked.samples, *light, grey, options, stop, report));
    if (stop.stop_requested()) return stopped();
    progress.add(cell.count);
  }

  if (neighborhood.baked && !baked.geometry.triangles.empty()) {
    const SurfaceBody body(view, {.direct = light->direct.field,
                                  .bounced = light->bounced ? &light->bounced->field : nullptr,
                                  .brdfs = brdfs ? &*brdfs : nullptr,
                                  .glossy = light->glossy ? &light->glossy->field : nullptr});
    const Box3 bounds{baked.geometry.bounds_min, baked.geometry.bounds_max};
    if (!bakeAround(body, bounds, baked.geometry.origin, group.name, neighborhood,
                    raysAroundSurfaces(options), options, progress, stop, report, baked.neighborhood))
      return stopped();
  }
  return baked;
}

}  // namespace lambent::baker
