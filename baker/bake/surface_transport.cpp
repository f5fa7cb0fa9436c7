#include <algorithm>
#include <memory>
#include <vector>

#include "baker/bake/bake_group.hpp"
#include "baker/effects/surface/inside_faces.hpp"
#include "baker/trace/patches.hpp"
#include "runtime/base/process.hpp"

namespace lambent::baker {

namespace {

// The light that further passes would add may be this share of the bound on the coding error.
constexpr double kTailShare = 0.3;

// The array is indexed by SurfacePart; an entry is null if nothing is fitted.
using Fits = std::array<std::unique_ptr<InsideFaces>, 2>;

// Traces direct light of one part of the samples, and fits it to points inside faces. Without bounces these
// points are not kept. Returns false if stopped.
bool tracePart(const DirectPass& pass, SurfacePart part, const GroupScene& group, const BakeContext& context,
               SurfaceTransport& light, Fits& fits) {
  const bool glossy = part == SurfacePart::Glossy;
  if (stretchOf(group.samples, part).empty()) return true;
  const BakeContext own = context.keyed(glossy ? group.keys.glossy_rays : group.keys.rays);
  SurfaceFigures& figures = light.figures;
  SurfaceFigures::Rays& rays = glossy ? figures.glossy : figures.diffuse;
  std::uint64_t hit_bytes = 0;
  const auto count = [&](const TracedPart& traced) {
    rays.traced += traced.rays, rays.kept += traced.rays_kept;
    hit_bytes += traced.hits.bytes();
    figures.ray_seconds += context.progress.now().seconds;
  };
  if (!traceDirect(pass, part, own, glossy ? "glossy shadows" : "direct light", light.direct)) return false;
  count(light.direct.of(part));
  figures.filled_samples += light.direct.of(part).filled_samples;
  if (glossy ? group.bake.options.fitsGlossy() : group.bake.options.fitsDiffuse()) {
    auto& inside = fits[static_cast<std::size_t>(part)];
    if (!fitInsideFaces(pass, part, own, light.direct, inside)) return false;
    if (inside) count(inside->points().direct.of(part));
    if (!pass.settings().keep_hits) inside.reset();
  }
  figures.hit_bytes = std::max(figures.hit_bytes, hit_bytes);
  return true;
}

// Returns how many bytes the results of bounces take at most, beyond what direct light holds.
std::uint64_t bytesOfBounces(const DirectResult& direct, const Fits& fits, const TracedView& view,
                             const BakeOptions& options) {
  // The sum of all passes, the last two of them, and two copies while one is fitted to points inside faces.
  constexpr std::size_t kFields = 5;
  std::size_t floats = kFields * direct.field.vectors.size() + direct.mapped.vectors.size();
  if (const auto& inside = fits[0]) {
    const DirectResult& there = inside->points().direct;
    floats += there.field.vectors.size() + 2 * there.mapped.vectors.size();
  }
  const ViewPoints& watched = view.of(SurfacePart::Matte);
  for (const TracedPoints* const points : {watched.noisy.get(), watched.exact.get()})
    if (points) floats += points->direct.field.vectors.size();
  // Patches pass light on by a matrix.
  const std::size_t glossy = direct.glossy.size();
  const std::size_t patches = std::min(kMostPatches, direct.field.size() + glossy);
  if (options.bounces != 1) floats += patches * patches * direct.field.channels;
  // The last two passes have the bands of exit kernels, and so has a pass at points inside faces; their sum
  // has those that ship.
  const GlossyField& field = direct.glossy;
  const std::size_t columns = field.channels * (squared(field.order_in) + field.light_columns);
  const std::size_t exits = squared(field.order_out) * columns;
  floats += glossy * (2 * exits + squared(options.glossy_order) * columns);
  if (const auto& inside = fits[1]) floats += inside->points().size() * exits;
  return floats * sizeof(float);
}

// Keeps the memory of bounces within the limit of the bake: hits that were kept for them are given up where
// their results need the room, and are traced again then.
void makeRoomForBounces(const BakeOptions& options, const TracedView& view, DirectResult& direct,
                        Fits& fits) {
  std::vector<HitStore*> stores;
  for (const SurfacePart part : {SurfacePart::Matte, SurfacePart::Glossy}) {
    stores.push_back(&direct.of(part).hits);
    if (const auto& inside = fits[static_cast<std::size_t>(part)])
      stores.push_back(&inside->points().direct.of(part).hits);
  }
  std::uint64_t held = 0;
  for (const HitStore* store : stores) held += store->bytes();
  const std::uint64_t resident = residentBytes();
  const std::uint64_t needed =
      bytesOfBounces(direct, fits, view, options) + resident - std::min(held, resident);
  const std::uint64_t limit = options.effectiveMemory();
  const std::uint64_t room = limit - std::min(limit, needed);
  if (held <= room) return;
  const double share = static_cast<double>(room) / static_cast<double>(held);
  for (HitStore* store : stores)
    store->keepAtMost(static_cast<std::size_t>(share * static_cast<double>(store->bytes())));
  returnFreedMemory();
}

// Computes the light between surfaces; hits are not needed after it. Returns false if stopped.
bool bounce(const DirectPass& pass, const GroupScene& group, const BakeContext& context, Fits fits,
            SurfaceTransport& light) {
  const BakeOptions& options = group.bake.options;
  makeRoomForBounces(options, light.view, light.direct, fits);
  LightToBounce from{.pass = pass, .direct = light.direct};
  ExitKernels kernels;
  if (const SurfaceBrdfs* const brdfs = group.brdfs()) {
    kernels = {.grey = brdfs->grey(),
               .at = [brdfs](std::uint32_t triangle, float u, float v, const glm::vec3& to,
                             std::span<float> out) { brdfs->exitKernel(triangle, u, v, to, out); }};
    from.kernels = &kernels;
  }
  for (std::size_t part = 0; part < fits.size(); ++part) {
    from.fits[part] = fits[part].get();
    if (fits[part]) light.inside[part] = fits[part]->points().size();
  }
  for (const ViewPoints& part : light.view.parts)
    for (TracedPoints* const points : {part.noisy.get(), part.exact.get()})
      if (points) from.watched.push_back(points);
  const double tail = options.leavesNothingOut() ? 0.0 : kTailShare * double{options.effectiveErrorBound()};
  light.bounced =
      bakeBounces(from, {options.bounces, tail, options.glossy_order}, context.keyed(group.keys.bounces));
  if (!light.bounced) return false;
  light.direct.parts = {};
  for (TracedPoints* const points : from.watched)
    for (TracedPart& part : points->direct.parts) part.hits = HitStore();
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
  // Bands of matrices beyond those that ship serve exit kernels alone.
  const DirectPass pass(group.view(), {.order = options.order,
                                       .rays = options.effectiveRays(),
                                       .keep_hits = bounces,
                                       .hit_memory = room / (brdfs ? 2 : 1),
                                       .colored_kernels = brdfs && !brdfs->grey(),
                                       .order_out = bounces ? options.exitOrder() : options.glossy_order});
  std::optional<SurfaceTransport> light(std::in_place);
  light->direct = pass.untraced();
  light->figures.glossy_samples = group.samples.glossy.size();
  Fits fits;
  if (!tracePart(pass, SurfacePart::Matte, group, context, *light, fits) ||
      !tracePart(pass, SurfacePart::Glossy, group, context, *light, fits) ||
      !diffuseFromGlossy(pass, light->direct, context.stop))
    return std::nullopt;
  auto view = traceView(pass, group, context);
  if (!view) return std::nullopt;
  light->view = std::move(*view);
  if (bounces && !bounce(pass, group, context, std::move(fits), *light)) return std::nullopt;
  return light;
}

}  // namespace lambent::baker
