#include "baker/bake/surface_transport.hpp"

#include <algorithm>
#include <vector>

#include "baker/effects/diffuse/traced_points.hpp"
#include "baker/effects/glossy/glossy_bounces.hpp"
#include "baker/effects/glossy/traced_points.hpp"
#include "baker/trace/patches.hpp"
#include "runtime/base/process.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

BakeContext insideContext(const BakeContext& context, std::span<const std::uint32_t> triangles) {
  if (!context.keeps()) return context;
  KeyMaker key = KeyMaker::ofStage("inside faces");
  return context.keyed(key.add(context.key).addList(triangles).key());
}

}  // namespace

std::optional<FitFigures> fitDiffuse(const DirectPass& pass, const TracedScene& scene, DirectResult& direct,
                                     const BakeContext& context) {
  const auto triangles = changingDiffuse(scene, direct.field);
  if (triangles.empty()) return FitFigures{};
  const auto inside = std::make_shared<DiffuseInsideFaces>(pass, scene, triangles, direct.hits.bytesLeft());
  if (!inside->look(insideContext(context, triangles))) return std::nullopt;
  const DirectResult& found = inside->points().direct();
  const FitFigures figures{inside->points().size(), found.field.rays, found.rays_kept,
                           context.progress.now().seconds};
  if (!inside->fit(found.field, 1.0f, direct.field, context.stop) ||
      !inside->fitMapped(found.mapped, direct.mapped, context.stop))
    return std::nullopt;
  if (pass.settings().keep_hits) direct.inside = inside;
  return figures;
}

std::optional<FitFigures> fitGlossy(const GlossyPass& pass, GlossyDirect& glossy,
                                    const BakeContext& context) {
  const TracedScene& scene = pass.scene();
  GlossyField& field = glossy.field;
  const SampleStretch& stretch = scene.samples.glossy;
  auto triangles =
      changingTriangles(scene.geometry, scene.samples, stretch, field.visibilitySize(), field.visibility);
  std::erase_if(triangles, [&](std::uint32_t t) { return !scene.matters(t); });
  if (triangles.empty()) return FitFigures{};
  const auto inside = std::make_shared<GlossyInsideFaces>(pass, triangles);
  const auto found = inside->look(glossy.hits.bytesLeft(), insideContext(context, triangles));
  if (!found) return std::nullopt;
  const GlossyDirect& traced = inside->points().direct();
  const FitFigures figures{inside->points().size(), traced.rays, traced.rays_kept,
                           context.progress.now().seconds};
  if (!inside->fit(found->visibility, field.visibility, context.stop) ||
      !inside->fit(found->lights_shadowed, field.lights_shadowed, context.stop))
    return std::nullopt;
  if (pass.plain().settings().keep_hits) glossy.inside = inside;
  return figures;
}

namespace {

// The light that further passes would add may be this share of the bound on the coding error.
constexpr double kTailShare = 0.3;

void add(const FitFigures& fit, SurfaceFigures::Rays& rays, SurfaceFigures& figures) {
  rays.traced += fit.rays, rays.kept += fit.rays_kept;
  figures.ray_seconds += fit.ray_seconds;
}

// Traces direct light of diffuse samples. Returns false if stopped.
bool traceDiffuse(const DirectPass& pass, const GroupScene& group, const BakeContext& context,
                  SurfaceTransport& light) {
  const BakeContext own = context.keyed(group.keys.rays);
  SurfaceFigures& figures = light.figures;
  auto direct = bakeDirect(pass, group.view(), own);
  if (!direct) return false;
  light.direct = std::move(*direct);
  figures.ray_seconds += context.progress.now().seconds;
  figures.diffuse = {light.direct.field.rays, light.direct.rays_kept};
  figures.filled_samples = light.direct.field.filled_samples;
  if (group.bake.options.fitsDiffuse()) {
    const auto fit = fitDiffuse(pass, group.view(), light.direct, own);
    if (!fit) return false;
    add(*fit, figures.diffuse, figures);
  }
  figures.hit_bytes = light.direct.hits.bytes();
  if (const auto& inside = light.direct.inside) figures.hit_bytes += inside->points().direct().hits.bytes();
  return true;
}

// Traces direct light of glossy samples, and derives their diffuse transfer from it. Returns false if
// stopped.
bool traceGlossy(const GlossyPass& pass, const GroupScene& group, const BakeContext& context,
                 SurfaceTransport& light) {
  const BakeContext own = context.keyed(group.keys.glossy_rays);
  SurfaceFigures& figures = light.figures;
  light.glossy = bakeGlossyDirect(pass, pass.plain().settings().hit_memory, light.direct.looks, own);
  if (!light.glossy) return false;
  GlossyDirect& glossy = *light.glossy;
  figures.ray_seconds += context.progress.now().seconds;
  figures.glossy = {glossy.rays, glossy.rays_kept};
  figures.filled_samples += glossy.filled_samples;
  if (group.bake.options.fitsGlossy()) {
    const auto fit = fitGlossy(pass, glossy, own);
    if (!fit) return false;
    add(*fit, figures.glossy, figures);
  }
  if (!diffuseFromGlossy(pass, glossy.field, light.direct, context.stop)) return false;
  const std::uint64_t inside = glossy.inside ? glossy.inside->points().direct().hits.bytes() : 0;
  figures.hit_bytes = std::max<std::uint64_t>(figures.hit_bytes, glossy.hits.bytes() + inside);
  figures.glossy_samples = glossy.field.size();
  return true;
}

std::size_t coefficients(int order) {
  return static_cast<std::size_t>(sh::coefficientCount(order));
}

// Bounces hold the sum of all passes, the last two of them, and two copies while one is fitted to points
// inside faces.
std::size_t floatsOfDiffuse(const DirectResult& direct) {
  constexpr std::size_t kFields = 5;
  std::size_t floats = kFields * direct.field.vectors.size() + direct.mapped.vectors.size();
  if (direct.inside) {
    const DirectResult& there = direct.inside->points().direct();
    floats += there.field.vectors.size() + 2 * there.mapped.vectors.size();
  }
  for (const auto& points : direct.watched) floats += points->direct().field.vectors.size();
  return floats;
}

// Patches pass light on by a matrix.
std::size_t floatsOfPatches(const DirectResult& direct, std::size_t glossy) {
  const std::size_t patches = std::min(kMostPatches, direct.field.size() + glossy);
  return patches * patches * direct.field.channels;
}

// The last two passes have the bands of exit kernels, and so has a pass at points inside faces; their sum has
// those that ship.
std::size_t floatsOfGlossy(const GlossyDirect& glossy, const BakeOptions& options) {
  const GlossyField& field = glossy.field;
  const std::size_t columns = field.channels * (coefficients(field.order_in) + field.light_columns);
  const std::size_t exits = coefficients(field.order_out) * columns;
  std::size_t floats = field.size() * (2 * exits + coefficients(options.glossy_order) * columns);
  if (glossy.inside) floats += glossy.inside->points().size() * exits;
  return floats;
}

// Returns how many bytes the results of bounces take at most, beyond what direct light holds.
std::uint64_t bytesOfBounces(const SurfaceTransport& light, const BakeOptions& options) {
  std::size_t floats = floatsOfDiffuse(light.direct);
  if (options.bounces != 1)
    floats += floatsOfPatches(light.direct, light.glossy ? light.glossy->field.size() : 0);
  if (light.glossy) floats += floatsOfGlossy(*light.glossy, options);
  return floats * sizeof(float);
}

// Keeps the memory of bounces within the limit of the bake: hits that were kept for them are given up where
// their results need the room, and are traced again then.
void makeRoomForBounces(const BakeOptions& options, SurfaceTransport& light) {
  std::vector<HitStore*> stores = {&light.direct.hits};
  if (light.direct.inside) stores.push_back(&light.direct.inside->points().direct().hits);
  if (light.glossy) {
    stores.push_back(&light.glossy->hits);
    if (light.glossy->inside) stores.push_back(&light.glossy->inside->points().direct().hits);
  }
  std::uint64_t held = 0;
  for (const HitStore* store : stores) held += store->bytes();
  const std::uint64_t resident = residentBytes();
  const std::uint64_t needed = bytesOfBounces(light, options) + resident - std::min(held, resident);
  const std::uint64_t limit = options.effectiveMemory();
  const std::uint64_t room = limit - std::min(limit, needed);
  if (held <= room) return;
  const double share = static_cast<double>(room) / static_cast<double>(held);
  for (HitStore* store : stores)
    store->keepAtMost(static_cast<std::size_t>(share * static_cast<double>(store->bytes())));
  returnFreedMemory();
}

// Computes the light between surfaces; hits are not needed after it. Returns false if stopped.
bool bounce(const DirectPass& pass, const GlossyPass* glossy_pass, const GroupScene& group,
            const BakeContext& context, SurfaceTransport& light) {
  const BakeOptions& options = group.bake.options;
  makeRoomForBounces(options, light);
  ExitKernels kernels;
  std::optional<GlossyBounces> partner;
  if (glossy_pass) {
    kernels = {
        .grey = group.brdfs()->grey(),
        .at = [brdfs = group.brdfs()](std::uint32_t triangle, float u, float v, const glm::vec3& to,
                                      std::span<float> out) { brdfs->exitKernel(triangle, u, v, to, out); }};
    partner.emplace(*glossy_pass, kernels, light.direct, *light.glossy, options.glossy_order);
  }
  const double tail = options.leavesNothingOut() ? 0.0 : kTailShare * double{options.effectiveErrorBound()};
  light.bounced = bakeBounces(pass, light.direct, group.view(), {options.bounces, tail},
                              context.keyed(group.keys.bounces), partner ? &*partner : nullptr);
  if (!light.bounced) return false;
  if (partner) {
    partner->finish();
    light.glossy->hits = HitStore();
    if (light.glossy->inside) light.inside_glossy = light.glossy->inside->points().size();
    light.glossy->inside.reset();
    for (const auto& points : light.glossy->watched) points->direct().hits = HitStore();
  }
  light.direct.hits = HitStore();
  if (light.direct.inside) light.inside_diffuse = light.direct.inside->points().size();
  light.direct.inside.reset();
  light.figures.pass_energy = light.bounced->energy;
  light.figures.left_out = light.bounced->left_out;
  return true;
}

}  // namespace

std::optional<SurfaceTransport> transportLight(const GroupScene& group, const BakeContext& context) {
  const BakeOptions& options = group.bake.options;
  const SurfaceBrdfs* const brdfs = group.brdfs();
  const bool bounces = group.bounces();
  const std::uint64_t room =
      options.memoryLeft(residentBytes(), group.samples.diffuse.size(), group.samples.glossy.size());
  const DirectPass pass(group.view(), {.order = options.order,
                                       .rays = options.effectiveRays(),
                                       .keep_hits = bounces,
                                       .hit_memory = room / (brdfs ? 2 : 1),
                                       .colored_kernels = brdfs && !brdfs->grey()});
  std::optional<SurfaceTransport> light(std::in_place);
  if (!traceDiffuse(pass, group, context, *light)) return std::nullopt;
  std::optional<GlossyPass> glossy_pass;
  if (brdfs) {
    // Bands beyond those that ship serve exit kernels alone.
    glossy_pass.emplace(pass, group.view(), bounces ? options.exitOrder() : options.glossy_order);
    if (!traceGlossy(*glossy_pass, group, context, *light)) return std::nullopt;
  }
  auto view = traceView(pass, options.glossy_order, group.view(), group.importance(), context);
  if (!view) return std::nullopt;
  light->view = std::move(*view);
  if (light->view.noisy) light->direct.watched = {light->view.noisy, light->view.exact};
  if (light->view.noisy_glossy) light->glossy->watched = {light->view.noisy_glossy, light->view.exact_glossy};
  if (bounces && !bounce(pass, glossy_pass ? &*glossy_pass : nullptr, group, context, *light))
    return std::nullopt;
  return light;
}

std::optional<bundle::PictureError> shownBy(const GroupScene& group, const SurfaceTransport& light,
                                            const std::vector<std::vector<CodedTransfer>>* cells) {
  auto shown = measurePictureError(
      light.view, group.view(),
      {.direct = light.direct.field,
       .mapped = light.direct.mapped,
       .bounced = light.bounced ? &*light.bounced : nullptr,
       .bounced_at_points = light.bounced ? std::span<const TransferField>(light.bounced->at_watched)
                                          : std::span<const TransferField>(),
       .glossy = light.glossy ? &light.glossy->field : nullptr,
       .brdfs = group.brdfs(),
       .cells = cells});
  if (shown) shown->bound = group.bake.options.effectivePictureBound();
  return shown;
}

void dropTransport(const GroupScene& group, const SurfaceTransport& light, const BakeContext& context) {
  const BakeContext bounces = context.keyed(group.keys.bounces);
  if (light.bounced && bounces.keeps())
    dropBounces(group.view(), light.inside_diffuse, light.inside_glossy, bounces);
}

}  // namespace lambent::baker
