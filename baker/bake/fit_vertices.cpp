#include "baker/bake/fit_vertices.hpp"

#include "baker/effects/diffuse/traced_points.hpp"
#include "baker/effects/glossy/traced_points.hpp"

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

}  // namespace lambent::baker
