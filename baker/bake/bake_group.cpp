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
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

namespace {

// Neighborhoods get this share of the bound on coded transfer, since they are seen against nearly open sky,
// where errors show.
constexpr double kShareOfBound = 1.0 / 3.0;
// The bound on the change at the faces of grids around bodies that are moved by hand. These grids have no
// more points than others, and lie close around the body, where its contact with what it stands on shows.
constexpr double kBoundByHand = 0.03;

}  // namespace

Result<void> bakeAround(const Around& around, const BakeContext& light,
                        const std::function<Result<std::unique_ptr<Body>>()>& make, BakedGroup& out,
                        BakeReport& report) {
  const auto& [bake, group, origin, bounds, rays] = around;
  const PlannedNeighborhood& plan = bake.plan.neighborhoods[group];
  if (!plan.baked) return {};
  const BakeOptions& options = bake.options;
  NeighborhoodSettings settings{.placement = {.body = bounds,
                                              .receivers = {},
                                              .size = plan.size,
                                              .by_length = options.neighborhood_grid,
                                              .few_points = !plan.asked && !plan.matrices,
                                              .extent = plan.extent},
                                .facing = plan.receivers_face,
                                .origin = origin,
                                .matrices = plan.matrices,
                                .rays = rays,
                                .fit_between_points = true,
                                .coding = {.bound = kShareOfBound * double{options.effectiveErrorBound()}}};
  if (!plan.receivers.empty() && !plan.by_hand)
    settings.placement.receivers = Box3{plan.receivers_min - origin, plan.receivers_max - origin};
  if (plan.by_hand) settings.placement.bound = kBoundByHand;

  const std::optional<Box3>& receivers = settings.placement.receivers;
  KeyMaker key = KeyMaker::ofStage("neighborhood");
  key.add(light.key, origin, std::uint64_t{rays}, plan.asked, plan.by_hand, plan.matrices, plan.size,
          plan.extent, receivers.has_value());
  if (receivers) key.add(receivers->low).add(receivers->high);
  key.add(plan.receivers_face, options.neighborhood_grid, options.effectiveErrorBound());
  const BakeContext context = light.keyed(light.keeps() ? key.key() : Key{});
  BakedAround baked;
  if (!findNeighborhood(context, baked)) {
    const auto body = make();
    if (!body) return failAgain(body.error());
    auto made = bakeNeighborhood(**body, settings, context);
    if (!made) return bake.stopped();
    baked = std::move(*made);
  }
  const std::string& name = bake.plan.groups[group].name;
  if (!baked.grid) {
    report.notices.push_back(fmt::format(
        "rigid group \"{}\": nothing comes within reach of its neighborhood, and none was baked", name));
    return {};
  }
  out.neighborhood = std::move(baked.grid);
  const NeighborhoodFigures& figures = baked.figures;
  report.rays += figures.rays;
  report.rays_kept += figures.rays_kept;
  report.neighborhoods.push_back({.name = name,
                                  .size = out.neighborhood->size,
                                  .bounds_min = out.neighborhood->bounds_min,
                                  .bounds_max = out.neighborhood->bounds_max,
                                  .inside_points = figures.inside_points,
                                  .error = figures.error,
                                  .change_error = figures.change_error});
  return {};
}

template <>
inline constexpr auto kKeptMembers<LightProbes::Cell> = std::tuple(&LightProbes::Cell::points,
                                                                   &LightProbes::Cell::weights);
template <>
inline constexpr auto kKeptMembers<LightProbes> = std::tuple(&LightProbes::points, &LightProbes::cells);

template <>
inline constexpr auto kKeptMembers<BakedProxy> = std::tuple(&BakedProxy::bytes, &BakedProxy::triangles);

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
    if (const auto shown = measurePictureError(group, light, nullptr))
      bound = codesBound(*shown, options.picture_bound);
  for (int codings = 1; bound; ++codings) {
    out.figures.codes_bound = *bound;
    out.figures.glossy_codes_bound = chooses ? glossyCodesBound(*bound) : options.effectiveGlossyErrorBound();
    out.figures.worst_error = light.figures.worst_error;
    out.figures.worst_glossy_error = light.figures.worst_glossy_error;
    if (group.anyGlossy() && !code(/*glossy=*/true)) return std::nullopt;
    if (!code(/*glossy=*/false)) return std::nullopt;
    auto& shown = out.figures.picture_error = measurePictureError(group, light, &out.cells);
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
Result<BakedProxy> proxyOf(GroupScene& group, const BakeContext& context) {
  BakedProxy proxy;
  Result<void> loaded;
  findOrMake(context.keyed(group.keys.proxy), proxy, [&] {
    loaded = group.loadColors();
    if (loaded) loaded = group.findImportance(context);
    context.progress.begin("proxy");
    if (!loaded) return false;
    const bundle::CaptureProxy made =
        makeCaptureProxy(group.geometry, group.samples, group.colors(), group.importance());
    proxy = {};
    if (!made.levels.empty()) proxy.bytes = bundle::encodeCaptureProxy(made);
    for (const bundle::ProxyLevel& level : made.levels) proxy.triangles.push_back(level.triangle_count);
    return true;
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
  own.proxy_triangles = baked.proxy.triangles;
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

  // Results that are found need neither colours nor rays.
  std::optional<SurfaceTransport> light;
  const auto transport = [&]() -> Result<void> {
    if (light) return {};
    if (auto prepared = group.prepareRays(context); !prepared) return prepared;
    light = transportLight(group, context);
    if (!light) return bake.stopped();
    return {};
  };
  Result<void> made;
  CachedCoding coding(context);
  const BakeContext cells_context = context.keyed(group.keys.cells);
  const auto found = findOrMake(cells_context, baked.surfaces, [&] {
    if (made = transport(); !made) return false;
    auto coded = codeSurfaces(group, *light, coding, context.progress);
    if (coded)
      baked.surfaces = std::move(*coded);
    else
      made = bake.stopped();
    return made.has_value();
  });
  if (!found) return failAgain(made.error());
  coding.drop();
  SurfaceFigures& figures = baked.surfaces.figures;
  if (*found)
    for (SurfaceFigures::Rays* rays : {&figures.diffuse, &figures.glossy})
      rays->kept += std::exchange(rays->traced, 0);
  reportSurfaces(group, figures, *found, report);

  // The body sends the light that the cells were coded from, so their key serves the neighborhood too.
  const auto body = [&]() -> Result<std::unique_ptr<Body>> {
    if (auto traced = transport(); !traced) return failAgain(traced.error());
    if (*found) report.rays += light->figures.diffuse.traced + light->figures.glossy.traced;
    return std::make_unique<SurfaceBody>(
        group.view(), BakedSurfaces{.direct = light->direct.field,
                                    .bounced = light->bounced ? &light->bounced->field : nullptr,
                                    .sends = bake.options.bounces != 0,
                                    .brdfs = group.brdfs(),
                                    .glossy = light->glossy()});
  };
  // A sample of a surface spreads its rays over a hemisphere; a point in free space spreads them over the
  // directions that the body fills, and the body's rim counts.
  const Around around{bake,
                      index,
                      group.geometry.origin,
                      {group.geometry.bounds_min, group.geometry.bounds_max},
                      2 * bake.options.effectiveRays()};
  if (!group.geometry.triangles.empty())
    if (auto done = bakeAround(around, cells_context, body, baked, report); !done)
      return failAgain(done.error());
  if (const BakeContext bounces = context.keyed(group.keys.bounces);
      light && light->bounced && bounces.keeps())
    dropBounces(group.samples, light->inside, bounces);
  baked.geometry = std::move(group.geometry);
  baked.samples = std::move(group.samples);
  baked.lights = std::move(group.lights);
  return baked;
}

}  // namespace lambent::baker
