#include "baker/bake/fit_vertices.hpp"

#include <algorithm>

#include "baker/effects/glossy/inside_faces.hpp"
#include "baker/trace/vertex_fit.hpp"
#include "baker/transport/face_points.hpp"

namespace lambent::baker {

namespace {

BakeContext insideContext(const BakeContext& context, std::span<const std::uint32_t> triangles) {
  if (!context.keeps()) return context;
  KeyMaker key = KeyMaker::ofStage("inside faces");
  return context.keyed(key.add(context.key).addList(triangles).key());
}

// Inside faces the same rays are traced as at the vertices, but their hits are not kept.
DirectSettings settingsInside(const DirectSettings& settings) {
  DirectSettings inside = settings;
  inside.keep_hits = false;
  inside.hit_memory = 0;
  return inside;
}

// A Part is a range of values at vertices, `width` each, and what rays from inside the faces found in their
// place.
struct Part {
  std::size_t width;
  std::span<const float> at_points;
  std::span<float> values;
};

}  // namespace

std::optional<FitFigures> fitDiffuse(const DirectPass& pass, const TracedScene& scene, DirectResult& direct,
                                     const BakeContext& context) {
  const SampleStretch &plain = scene.samples.diffuse, &mapped = scene.samples.normal_mapped;
  const std::size_t width = direct.field.vectorSize();
  const auto fieldOf = [&](const SampleStretch& stretch) {
    return std::span(direct.field.vectors).subspan(stretch.begin * width, stretch.size() * width);
  };
  std::vector<std::uint32_t> triangles;
  for (const SampleStretch& stretch : {plain, mapped}) {
    const auto own = changingTriangles(scene.geometry, scene.samples, stretch, width, fieldOf(stretch));
    triangles.insert(triangles.end(), own.begin(), own.end());
  }
  if (triangles.empty()) return FitFigures{};
  const FacePoints points = facePoints(scene.geometry, scene.samples, triangles);
  const TracedScene inside = scene.withSamples(points.samples);
  const auto found = bakeDirect(DirectPass(inside, settingsInside(pass.settings())), inside,
                                insideContext(context, triangles), "inside faces");
  if (!found) return std::nullopt;
  const FitFigures figures{points.samples.size(), found->field.rays, found->rays_kept,
                           context.progress.now().seconds};
  const auto fit = [&](const SampleStretch& stretch, const SampleStretch& of_points,
                       std::initializer_list<Part> parts) {
    const VertexFit vertices(scene.geometry, scene.samples, stretch, points, of_points, found->looks.valid);
    return std::all_of(parts.begin(), parts.end(), [&](const Part& part) {
      return vertices.apply(part.width, part.at_points, part.values, context.stop);
    });
  };
  const SampleStretch &diffuse_points = points.samples.diffuse, &mapped_points = points.samples.normal_mapped;
  const auto foundIn = [&](const SampleStretch& stretch) {
    return std::span(found->field.vectors).subspan(stretch.begin * width, stretch.size() * width);
  };
  const bool fitted = fit(plain, diffuse_points, {{width, foundIn(diffuse_points), fieldOf(plain)}}) &&
                      fit(mapped, mapped_points,
                          {{width, foundIn(mapped_points), fieldOf(mapped)},
                           {direct.mapped.vectorSize(), found->mapped.vectors, direct.mapped.vectors}});
  return fitted ? std::optional(figures) : std::nullopt;
}

std::optional<FitFigures> fitGlossy(const GlossyPass& pass, GlossyDirect& glossy,
                                    const BakeContext& context) {
  const TracedScene& scene = pass.scene();
  GlossyField& field = glossy.field;
  const SampleStretch& stretch = scene.samples.glossy;
  const auto triangles =
      changingTriangles(scene.geometry, scene.samples, stretch, field.visibilitySize(), field.visibility);
  if (triangles.empty()) return FitFigures{};
  const auto inside = std::make_shared<GlossyInsideFaces>(pass, triangles);
  const auto found = inside->look(glossy.hits.bytesLeft(), insideContext(context, triangles));
  if (!found) return std::nullopt;
  const FitFigures figures{inside->size(), found->rays, found->rays_kept, context.progress.now().seconds};
  if (!inside->fit(found->field.visibility, field.visibility, context.stop) ||
      !inside->fit(found->field.lights_shadowed, field.lights_shadowed, context.stop))
    return std::nullopt;
  if (pass.plain().settings().keep_hits) glossy.inside = inside;
  return figures;
}

}  // namespace lambent::baker
