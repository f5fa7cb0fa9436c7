#include "baker/bake/bake_group.hpp"

#include <algorithm>
#include <optional>

#include "baker/bake/bake_around.hpp"
#include "baker/bake/group_scene.hpp"
#include "baker/bake/result_bytes.hpp"
#include "baker/bake/surface_cells.hpp"
#include "baker/effects/neighborhood/bodies.hpp"
#include "baker/jobs/kept_value.hpp"
#include "baker/proxy/capture_proxy.hpp"
#include "baker/transport/face_points.hpp"

namespace lambent::baker {

namespace {

LightProbes lightProbesOf(const GroupScene& group, const BakeContext& context) {
  context.progress.begin("light samples");
  LightProbes probes;
  findOrMake(context.keyed(group.keys.light_probes), probes, [&] {
    probes = chooseLightProbes(group.samples, sampleAreas(group.geometry, group.samples),
                               group.geometry.bounds_min, group.geometry.bounds_max,
                               group.bake.plan.light_probes[group.index].count);
    return true;
  });
  return probes;
}

// Colours and rays are needed only if the proxy was not found in the cache.
Result<bundle::CaptureProxy> proxyOf(GroupScene& group, const BakeContext& context) {
  bundle::CaptureProxy proxy;
  Result<void> loaded;
  findOrMake(context.keyed(group.keys.proxy), proxy, [&] {
    loaded = group.loadColors();
    if (loaded) loaded = group.findImportance(context);
    context.progress.begin("proxy");
    if (loaded) proxy = makeCaptureProxy(group.geometry, group.samples, group.colors(), group.importance());
    return loaded.has_value();
  });
  if (!loaded) return failAgain(loaded.error());
  return proxy;
}

// Adds to the report what it says of a group and its samples.
BakeReport::Group& tell(const GroupScene& group, const BakedGroup& baked) {
  BakeReport& report = group.bake.report;
  report.vertices += group.geometry.positions.size();
  report.triangles += group.geometry.triangles.size();
  report.samples += group.samples.size();
  report.lights += group.lights.size();
  BakeReport::Group& told = report.groups.emplace_back();
  told.name = group.group.name;
  told.light_probes = baked.light_probes.points.size();
  for (const bundle::ProxyLevel& level : baked.proxy.levels)
    told.proxy_triangles.push_back(level.triangle_count);
  return told;
}

// Adds to the report what it says of the light of surfaces, and of what each effect cost.
void tell(const GroupScene& group, const SurfaceFigures& figures, bool found, BakeReport::Group& told) {
  BakeReport& report = group.bake.report;
  report.filled_samples += figures.filled_samples;
  report.glossy_samples += figures.glossy_samples;
  report.hit_bytes = std::max(report.hit_bytes, figures.hit_bytes);
  report.worst_error = std::max(report.worst_error, figures.worst_error);
  report.worst_glossy_error = std::max(report.worst_glossy_error, figures.worst_glossy_error);
  report.left_out = std::max(report.left_out, figures.left_out);
  told.picture_error = figures.picture_error;
  told.codes_bound = figures.codes_bound, told.glossy_codes_bound = figures.glossy_codes_bound;
  if (figures.pass_energy.size() > report.pass_energy.size()) report.pass_energy = figures.pass_energy;
  report.ray_seconds += figures.ray_seconds;
  const auto add = [&](const char* name, const SurfaceFigures::Rays& rays) {
    const Reuse reuse = found                               ? Reuse::Found
                        : rays.traced > 0 || rays.kept == 0 ? Reuse::Baked
                                                            : Reuse::Regathered;
    told.effects.push_back({name, reuse, rays.traced, rays.kept});
    report.rays += rays.traced, report.rays_kept += rays.kept;
  };
  if (group.anyDiffuse()) add("diffuse", figures.diffuse);
  if (group.anyGlossy()) add("glossy", figures.glossy);
}

// Bakes the neighborhood of surfaces whose light is baked. Returns false if stopped.
bool bakeAroundSurfaces(const Around& around, const GroupScene& group, const SurfaceTransport& light,
                        const BakeContext& context, std::optional<BakedNeighborhood>& out) {
  const SurfaceBody body(group.view(), {.direct = light.direct.field,
                                        .bounced = light.bounced ? &light.bounced->field : nullptr,
                                        .sends = group.bake.options.bounces != 0,
                                        .brdfs = group.brdfs(),
                                        .glossy = light.glossy ? &light.glossy->field : nullptr});
  return bakeAround(around, body, {group.geometry.bounds_min, group.geometry.bounds_max}, context, out);
}

}  // namespace

Result<BakedGroup> bakeGroup(const SceneBake& bake, const SurfaceInputs& inputs, std::size_t index,
                             const BakeContext& context) {
  GroupScene group(bake, inputs, index, context);
  BakedGroup baked;
  baked.light_probes = lightProbesOf(group, context);
  auto proxy = proxyOf(group, context);
  if (!proxy) return failAgain(proxy.error());
  baked.proxy = std::move(*proxy);
  BakeReport::Group& told = tell(group, baked);
  const auto finished = [&] {
    baked.geometry = std::move(group.geometry);
    baked.samples = std::move(group.samples);
    baked.lights = std::move(group.lights);
    return std::move(baked);
  };

  // A result that is found needs neither colours nor rays. The body sends the light that the cells were coded
  // from, so their key serves the neighborhood too.
  const BakeContext cells_context = context.keyed(group.keys.cells);
  const Around around{bake, index, group.geometry.origin, raysAroundSurfaces(bake.options)};
  const BakeContext around_context = contextOf(around, cells_context);
  SurfaceCells cells;
  const bool found = findKept(cells_context, cells);
  if (found) tell(group, cells.figures, found, told);
  const bool any_around = bake.plan.neighborhoods[index].baked && !group.geometry.triangles.empty();
  const bool around_found = any_around && findAround(around, around_context, baked.neighborhood);
  const auto take = [&](SurfaceCells& from) {
    baked.cells = std::move(from.cells);
    baked.importance = std::move(from.importance);
    baked.picture_error = from.figures.picture_error;
    baked.codes_bound = from.figures.codes_bound, baked.glossy_codes_bound = from.figures.glossy_codes_bound;
  };
  if (found) take(cells);
  if (found && (!any_around || around_found)) return finished();
  if (auto prepared = group.prepareRays(context); !prepared) return failAgain(prepared.error());
  const auto light = transportLight(group, context);
  if (!light) return bake.stopped();
  if (!found) {
    CachedCoding coding(context);
    auto coded = codeSurfaces(group, *light, coding, context.progress);
    if (!coded) return bake.stopped();
    tell(group, coded->figures, found, told);
    keepValue(cells_context, *coded);
    coding.drop();
    take(*coded);
  } else {
    bake.report.rays += light->figures.diffuse.traced + light->figures.glossy.traced;
  }
  if (any_around && !around_found &&
      !bakeAroundSurfaces(around, group, *light, around_context, baked.neighborhood))
    return bake.stopped();
  dropTransport(group, *light, context);
  return finished();
}

}  // namespace lambent::baker
