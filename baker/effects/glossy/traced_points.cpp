#include "baker/effects/glossy/traced_points.hpp"

#include <utility>

namespace lambent::baker {

TracedGlossyPoints::TracedGlossyPoints(const TracedScene& scene, FacePoints points,
                                       const DirectSettings& settings, int order_out)
    : points_(std::move(points)),
      scene_(scene.withSamples(points_.samples)),
      plain_(scene_, settings),
      pass_(plain_, scene_, order_out),
      looks_{std::vector<std::uint8_t>(points_.samples.size(), 0),
             std::vector<RayCount>(points_.samples.size())} {}

bool TracedGlossyPoints::look(std::size_t hit_memory, const BakeContext& context, const char* stage) {
  auto found = bakeGlossyDirect(pass_, hit_memory, looks_, context, stage);
  if (!found) return false;
  direct_ = std::move(*found);
  return true;
}

GlossyInsideFaces::GlossyInsideFaces(const GlossyPass& vertices, std::span<const std::uint32_t> triangles)
    : vertices_(vertices),
      points_(vertices.scene(), facePoints(vertices.scene().geometry, vertices.scene().samples, triangles),
              vertices.plain().settings(), vertices.shape().order_out) {}

std::optional<GlossyField> GlossyInsideFaces::look(std::size_t hit_memory, const BakeContext& context) {
  if (!points_.look(hit_memory, context, "inside faces")) return std::nullopt;
  const TracedScene& scene = vertices_.scene();
  fit_.emplace(scene.geometry, scene.samples, scene.samples.glossy, points_.points(),
               SampleStretch{0, points_.size()}, points_.looks().valid);
  return std::exchange(points_.direct().field, {});
}

bool GlossyInsideFaces::fit(std::span<const float> at_points, std::span<float> at_vertices,
                            const std::stop_token& stop) const {
  if (at_vertices.empty()) return true;
  return fit_->apply(at_vertices.size() / vertices_.size(), at_points, at_vertices, stop);
}

}  // namespace lambent::baker
