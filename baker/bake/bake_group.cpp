#include "baker/bake/bake_group.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "baker/bake/group_scene.hpp"
#include "baker/bake/options.hpp"
#include "baker/brdf/surface_brdfs.hpp"
#include "baker/cache/key.hpp"
#include "baker/compress/kept_transfer.hpp"
#include "baker/effects/neighborhood/bodies.hpp"
#include "baker/effects/neighborhood/neighborhood.hpp"
#include "baker/effects/surface/cell_vectors.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/proxy/capture_proxy.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

namespace {

// Neighborhoods get this share of the bound on coded transfer, since they are seen against nearly open sky,
// where errors show.
constexpr double kShareOfBound = 1.0 / 3.0;
// The bound on the change at the faces of grids around bodies that are moved by hand. These grids have no
// more points than others, and lie close around the body, where its contact with what it stands on shows.
constexpr double kBoundByHand = 0.03;

void take(const Around& around, BakedAround baked, BakedGroup& out) {
  BakeReport& report = around.report;
  const std::string& name = around.bake.plan.groups[around.group].name;
  if (!baked.grid) {
    report.notices.push_back(fmt::format(
        "rigid group \"{}\": nothing comes within reach of its neighborhood, and none was baked", name));
    return;
  }
  out.neighborhood = std::move(baked.grid);
  const NeighborhoodFigures& figures = baked.figures;
  report.rays += figures.rays;
  report.rays_kept += figures.rays_kept;
  report.neighborhoods.push_back({.name = name,
                                  .size = figures.size,
                                  .bounds_min = figures.bounds_min,
                                  .bounds_max = figures.bounds_max,
                                  .inside_points = figures.inside_points,
                                  .error = figures.error,
                                  .change_error = figures.change_error});
}

// Returns the bounds of the surfaces that come within reach, relative to the origin.
std::optional<Box3> receiversOf(const Around& around) {
  const PlannedNeighborhood& plan = around.plan();
  if (plan.receivers.empty() || plan.by_hand) return std::nullopt;
  return Box3{plan.receivers_min - around.origin, plan.receivers_max - around.origin};
}

}  // namespace

BakeContext contextOf(const Around& around, const BakeContext& body) {
  if (!body.keeps()) return body;
  const PlannedNeighborhood& plan = around.plan();
  const BakeOptions& options = around.bake.options;
  const std::optional<Box3> receivers = receiversOf(around);
  KeyMaker key = KeyMaker::ofStage("neighborhood");
  key.add(body.key, around.origin, std::uint64_t{around.rays}, plan.asked, plan.by_hand, plan.matrices,
          plan.size, plan.extent, receivers.has_value());
  if (receivers) key.add(receivers->low).add(receivers->high);
  key.add(plan.receivers_face, options.neighborhood_grid, options.effectiveErrorBound());
  return body.keyed(key.key());
}

bool findAround(const Around& around, const BakeContext& context, BakedGroup& out) {
  BakedAround found;
  if (!findNeighborhood(context, found)) return false;
  take(around, std::move(found), out);
  return true;
}

bool bakeAround(const Around& around, const Body& body, const Box3& bounds, const BakeContext& context,
                BakedGroup& out) {
  const PlannedNeighborhood& plan = around.plan();
  const BakeOptions& options = around.bake.options;
  NeighborhoodSettings settings;
  settings.origin = around.origin;
  settings.matrices = plan.matrices;
  settings.rays = around.rays;
  settings.placement.body = bounds;
  if (const auto receivers = receiversOf(around)) settings.placement.receivers = *receivers;
  settings.facing = plan.receivers_face;
  settings.placement.size = plan.size;
  settings.placement.extent = plan.extent;
  settings.placement.by_length = options.neighborhood_grid;
  if (plan.by_hand) settings.placement.bound = kBoundByHand;
  settings.placement.few_points = !plan.asked && !plan.matrices;
  settings.fit_between_points = true;
  settings.coding.bound = kShareOfBound * double{options.effectiveErrorBound()};
  auto baked = bakeNeighborhood(body, settings, context);
  if (!baked) return false;
  take(around, std::move(*baked), out);
  return true;
}

template <>
inline constexpr auto kKeptMembers<LightProbes::Cell> = std::tuple(&LightProbes::Cell::points,
                                                                   &LightProbes::Cell::weights);
template <>
inline constexpr auto kKeptMembers<LightProbes> = std::tuple(&LightProbes::points, &LightProbes::cells);

template <>
inline constexpr auto kKeptMembers<bundle::ProxyTriangle> = std::tuple(
    &bundle::ProxyTriangle::vertices, &bundle::ProxyTriangle::front_only, &bundle::ProxyTriangle::emission,
    &bundle::ProxyTriangle::light, &bundle::ProxyTriangle::first_entry, &bundle::ProxyTriangle::entry_count);
template <>
inline constexpr auto kKeptMembers<bundle::ProxyEntry> = std::tuple(&bundle::ProxyEntry::sample,
                                                                    &bundle::ProxyEntry::reflectance);
template <>
inline constexpr auto kKeptMembers<bundle::ProxyLevel> = std::tuple(&bundle::ProxyLevel::first_triangle,
                                                                    &bundle::ProxyLevel::triangle_count,
                                                                    &bundle::ProxyLevel::error_m);
template <>
inline constexpr auto kKeptMembers<bundle::PatchTriangle> = std::tuple(&bundle::PatchTriangle::vertices,
                                                                       &bundle::PatchTriangle::front_only,
                                                                       &bundle::PatchTriangle::albedo,
                                                                       &bundle::PatchTriangle::detail);
template <>
inline constexpr auto kKeptMembers<bundle::PatchSurface> = std::tuple(&bundle::PatchSurface::positions,
                                                                      &bundle::PatchSurface::triangles,
                                                                      &bundle::PatchSurface::error_m);
template <>
inline constexpr auto kKeptMembers<bundle::CaptureProxy> = std::tuple(&bundle::CaptureProxy::positions,
                                                                      &bundle::CaptureProxy::triangles,
                                                                      &bundle::CaptureProxy::entries,
                                                                      &bundle::CaptureProxy::levels,
                                                                      &bundle::CaptureProxy::patches);

template <>
inline constexpr auto kKeptMembers<SurfaceFigures> = std::tuple(
    &SurfaceFigures::filled_samples, &SurfaceFigures::glossy_samples, &SurfaceFigures::hit_bytes,
    &SurfaceFigures::worst_error, &SurfaceFigures::worst_glossy_error, &SurfaceFigures::left_out,
    &SurfaceFigures::pass_energy, &SurfaceFigures::diffuse, &SurfaceFigures::glossy,
    &SurfaceFigures::picture_error, &SurfaceFigures::codes_bound, &SurfaceFigures::glossy_codes_bound);
template <>
inline constexpr auto kKeptMembers<SurfaceCells> = std::tuple(&SurfaceCells::cells, &SurfaceCells::importance,
                                                              &SurfaceCells::figures);

namespace {

// The share of visibility in the bound on glossy light, where light bounces: halving the error costs
// visibility a dozen bytes a vertex, and bounced light of sharp metals a hundred
// (docs/design/compression.md, "Glossy matrices").
constexpr float kOfVisibility = 0.35f;
// Eyes may see other errors of codes than those of all samples, so codes are made again with a better bound.
constexpr int kMostCodings = 3;

// Returns how much samples matter to pictures. Eyes may come to see any of them one day, so that none counts
// for nothing, and none for all.
std::vector<float> codingWeights(const SampleImportance& importance) {
  constexpr float kLeast = 0.05f, kMost = 4.0f;
  const auto count = static_cast<float>(importance.shares.size());
  std::vector<float> weights;
  for (const float share : importance.shares) weights.push_back(std::clamp(count * share, kLeast, kMost));
  return weights;
}

// Visibility and bounced light are shown together: errors of both are relative to both, and their squares add
// up to the square of the bound. A bound that was asked for is kept at any price.
std::vector<CodedTransfer> codeGlossy(const std::vector<CellVectors>& parts, std::size_t count,
                                      const BakeOptions& options, CodingSettings settings,
                                      CachedCoding& coding, SurfaceFigures& figures) {
  std::vector<CodedTransfer> coded;
  double shown = 0.0;
  bool any_bounced = false;
  for (const CellVectors& part : parts) {
    if (part.shape.order == 0) continue;  // transfer of the group's lights
    shown += transferEnergy(part.vectors, part.shape, settings.kernel_power);
    any_bounced |= !part.shape.isVisibility();
  }
  settings.most_components = options.error_bound > 0.0f ? kAllComponents : kUsualComponents;
  double square = 0.0;
  for (const CellVectors& part : parts) {
    const bool environment = part.shape.order > 0;
    settings.bound = figures.glossy_codes_bound;
    if (environment && any_bounced)
      settings.bound *=
          part.shape.isVisibility() ? kOfVisibility : std::sqrt(1.0f - kOfVisibility * kOfVisibility);
    settings.loose_bound = options.glossyLooseness() * settings.bound;
    settings.shown_energy = environment ? shown : 0.0;
    coded.push_back(coding.code(part.vectors, count, part.shape, settings));
    const double error = coded.back().error;
    if (environment)
      square += error * error;
    else
      figures.worst_glossy_error = std::max(figures.worst_glossy_error, error);
  }
  figures.worst_glossy_error = std::max(figures.worst_glossy_error, std::sqrt(square));
  return coded;
}

std::vector<CodedTransfer> codeDiffuse(const std::vector<CellVectors>& parts, std::size_t count,
                                       const CodingSettings& settings, CachedCoding& coding,
                                       SurfaceFigures& figures) {
  std::vector<CodedTransfer> coded;
  for (const CellVectors& vectors : parts) {
    coded.push_back(coding.code(vectors.vectors, count, vectors.shape, settings));
    figures.worst_error = std::max(figures.worst_error, double{coded.back().error});
  }
  return coded;
}

// Codes the importance of samples per area, relative to its mean over pictures.
std::vector<std::uint8_t> importanceCodes(const GroupScene& group) {
  const std::vector<float>& shares = group.view().importance->shares;
  const std::vector<float> areas = sampleAreas(group.geometry, group.samples);
  std::vector<double> densities;
  double sum = 0.0, all = 0.0;
  for (std::size_t s = 0; s < shares.size(); ++s) {
    densities.push_back(areas[s] > 0.0f ? double{shares[s]} / double{areas[s]} : 0.0);
    sum += double{shares[s]} * densities[s], all += double{shares[s]};
  }
  std::vector<std::uint8_t> codes;
  for (const double density : densities)
    codes.push_back(bundle::importanceCode(sum > 0.0 ? static_cast<float>(density * all / sum) : 0.0f));
  return codes;
}

// Returns nothing if stopped.
std::optional<SurfaceCells> codeSurfaces(const GroupScene& group, const SurfaceTransport& light,
                                         CachedCoding& coding, Progress& progress) {
  const BakeOptions& options = group.bake.options;
  SurfaceCells out{{}, importanceCodes(group), light.figures};
  out.cells.resize(group.samples.cells.size());
  const GreyColumns grey{.sky = group.colors().greyPanes(), .lights = group.colors().greyEmission()};
  const std::vector<float> weights = codingWeights(*group.view().importance);
  const BandPower kernel_power =
      group.brdfs() ? kernelPower(group.geometry, *group.brdfs(), options.glossy_order) : kLobePower;
  // Returns false if stopped.
  const auto code = [&](bool glossy) {
    progress.begin("coding", glossy ? group.samples.glossy.size() : group.samples.glossy.begin, "samples");
    for (std::size_t c = 0; c < out.cells.size(); ++c) {
      const SampleCell& cell = group.samples.cells[c];
      if ((cell.kind == SampleKind::Glossy) != glossy) continue;
      const auto parts =
          cellVectors(cell, group.samples, light.direct, light.bounced ? &*light.bounced : nullptr, grey);
      const auto own = std::span(weights).subspan(cell.first, cell.count);
      out.cells[c] = glossy
                         ? codeGlossy(parts, cell.count, options,
                                      {.kernel_power = kernel_power, .weights = own}, coding, out.figures)
                         : codeDiffuse(parts, cell.count, {.bound = out.figures.codes_bound, .weights = own},
                                       coding, out.figures);
      if (coding.stopped()) return false;
      progress.add(cell.count);
    }
    return true;
  };
  const bool chooses = options.picture_bound > 0.0f && options.error_bound == 0.0f;
  std::optional<float> bound = options.effectiveErrorBound();
  if (chooses)
    if (const auto shown = shownBy(group, light, nullptr)) bound = codesBound(*shown, options.picture_bound);
  for (int codings = 1; bound; ++codings) {
    out.figures.codes_bound = *bound;
    out.figures.glossy_codes_bound = chooses ? glossyCodesBound(*bound) : options.effectiveGlossyErrorBound();
    out.figures.worst_error = light.figures.worst_error;
    out.figures.worst_glossy_error = light.figures.worst_glossy_error;
    if (group.anyGlossy() && !code(/*glossy=*/true)) return std::nullopt;
    if (!code(/*glossy=*/false)) return std::nullopt;
    auto& shown = out.figures.picture_error = shownBy(group, light, &out.cells);
    bound.reset();
    if (chooses && shown && codings < kMostCodings)
      bound = nextCodesBound(out.figures.codes_bound, *shown, options.picture_bound);
  }
  return out;
}

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

// Adds to the report what there is to say of a group and its samples.
void reportGroup(const GroupScene& group, const BakedGroup& baked, BakeReport& report) {
  report.vertices += group.geometry.positions.size();
  report.triangles += group.geometry.triangles.size();
  report.samples += group.samples.size();
  report.lights += group.lights.size();
  std::ranges::copy(group.notices, std::back_inserter(report.notices));
  BakeReport::Group& own = report.groups.emplace_back();
  own.name = group.group.name;
  own.light_probes = baked.light_probes.points.size();
  for (const bundle::ProxyLevel& level : baked.proxy.levels)
    own.proxy_triangles.push_back(level.triangle_count);
}

// Adds to the report what it says of the light of the last group's surfaces, and of what each effect cost.
void reportSurfaces(const GroupScene& group, const SurfaceFigures& figures, bool found, BakeReport& report) {
  report.filled_samples += figures.filled_samples;
  report.glossy_samples += figures.glossy_samples;
  report.hit_bytes = std::max(report.hit_bytes, figures.hit_bytes);
  report.worst_error = std::max(report.worst_error, figures.worst_error);
  report.worst_glossy_error = std::max(report.worst_glossy_error, figures.worst_glossy_error);
  report.left_out = std::max(report.left_out, figures.left_out);
  report.ray_seconds += figures.ray_seconds;
  if (figures.pass_energy.size() > report.pass_energy.size()) report.pass_energy = figures.pass_energy;
  BakeReport::Group& own = report.groups.back();
  own.picture_error = figures.picture_error;
  own.codes_bound = figures.codes_bound, own.glossy_codes_bound = figures.glossy_codes_bound;
  const auto add = [&](const char* name, const SurfaceFigures::Rays& rays) {
    const Reuse reuse = found                               ? Reuse::Found
                        : rays.traced > 0 || rays.kept == 0 ? Reuse::Baked
                                                            : Reuse::Regathered;
    own.effects.push_back({name, reuse, rays.traced, rays.kept});
    report.rays += rays.traced, report.rays_kept += rays.kept;
  };
  if (group.anyDiffuse()) add("diffuse", figures.diffuse);
  if (group.anyGlossy()) add("glossy", figures.glossy);
}

// Finds the cells in the cache. Returns false if there are none.
bool findSurfaces(const BakeContext& context, SurfaceCells& cells) {
  if (!findKept(context, cells)) {
    cells = {};
    return false;
  }
  for (SurfaceFigures::Rays* rays : {&cells.figures.diffuse, &cells.figures.glossy})
    rays->kept += std::exchange(rays->traced, 0);
  return true;
}

// Bakes the neighborhood of surfaces whose light is baked. Returns false if stopped.
bool bakeAroundSurfaces(const Around& around, const GroupScene& group, const SurfaceTransport& light,
                        const BakeContext& context, BakedGroup& out) {
  const SurfaceBody body(group.view(), {.direct = light.direct.field,
                                        .bounced = light.bounced ? &light.bounced->field : nullptr,
                                        .sends = group.bake.options.bounces != 0,
                                        .brdfs = group.brdfs(),
                                        .glossy = light.glossy()});
  return bakeAround(around, body, {group.geometry.bounds_min, group.geometry.bounds_max}, context, out);
}

}  // namespace

Result<BakedGroup> bakeGroup(const SceneBake& bake, const SurfaceInputs& inputs, std::size_t index,
                             const BakeContext& context, BakeReport& report) {
  GroupScene group(bake, inputs, index, context);
  BakedGroup baked;
  baked.light_probes = lightProbesOf(group, context);
  auto proxy = proxyOf(group, context);
  if (!proxy) return failAgain(proxy.error());
  baked.proxy = std::move(*proxy);
  reportGroup(group, baked, report);

  // A result that is found needs neither colours nor rays. The body sends the light that the cells were coded
  // from, so their key serves the neighborhood too.
  const BakeContext cells_context = context.keyed(group.keys.cells);
  // A sample of a surface spreads its rays over a hemisphere; a point in free space spreads them over the
  // directions that the body fills, and the body's rim counts.
  const Around around{bake, index, group.geometry.origin, 2 * bake.options.effectiveRays(), report};
  const BakeContext around_context = contextOf(around, cells_context);
  const bool found = findSurfaces(cells_context, baked.surfaces);
  if (found) reportSurfaces(group, baked.surfaces.figures, found, report);
  const bool bakes_around =
      around.plan().baked && !group.geometry.triangles.empty() && !findAround(around, around_context, baked);
  if (!found || bakes_around) {
    if (auto prepared = group.prepareRays(context); !prepared) return failAgain(prepared.error());
    const auto light = transportLight(group, context);
    if (!light) return bake.stopped();
    if (found) {
      report.rays += light->figures.diffuse.traced + light->figures.glossy.traced;
    } else {
      CachedCoding coding(context);
      auto coded = codeSurfaces(group, *light, coding, context.progress);
      if (!coded) return bake.stopped();
      baked.surfaces = std::move(*coded);
      reportSurfaces(group, baked.surfaces.figures, found, report);
      keepValue(cells_context, baked.surfaces);
      coding.drop();
    }
    if (bakes_around && !bakeAroundSurfaces(around, group, *light, around_context, baked))
      return bake.stopped();
    dropTransport(group, *light, context);
  }
  baked.geometry = std::move(group.geometry);
  baked.samples = std::move(group.samples);
  baked.lights = std::move(group.lights);
  return baked;
}

}  // namespace lambent::baker
