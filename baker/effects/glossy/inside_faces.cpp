#include "baker/effects/glossy/inside_faces.hpp"

#include <utility>

namespace lambent::baker {

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
