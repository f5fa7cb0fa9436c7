#include "baker/effects/glossy/inside_faces.hpp"

#include <utility>

namespace lambent::baker {

GlossyInsideFaces::GlossyInsideFaces(const GlossyPass& vertices, std::span<const std::uint32_t> triangles)
    : vertices_(vertices),
      points_(facePoints(vertices.scene().geometry, vertices.scene().samples, triangles)),
      diffuse_(vertices.scene().withSamples(points_.samples), vertices.plain().settings()),
      pass_(diffuse_, vertices.scene().withSamples(points_.samples), vertices.shape().order_out),
      looks_{std::vector<std::uint8_t>(points_.samples.size(), 0),
             std::vector<std::uint8_t>(points_.samples.size(), 0)} {}

std::optional<GlossyDirect> GlossyInsideFaces::look(std::size_t hit_memory, const BakeContext& context) {
  auto found = bakeGlossyDirect(pass_, hit_memory, looks_, context, "inside faces");
  if (!found) return std::nullopt;
  hits_ = std::exchange(found->hits, {});
  const TracedScene& scene = vertices_.scene();
  fit_.emplace(scene.geometry, scene.samples, scene.samples.glossy, points_,
               SampleStretch{0, points_.samples.size()}, looks_.valid);
  return found;
}

bool GlossyInsideFaces::fit(std::span<const float> at_points, std::span<float> at_vertices,
                            const std::stop_token& stop) const {
  if (at_vertices.empty()) return true;
  return fit_->apply(at_vertices.size() / vertices_.size(), at_points, at_vertices, stop);
}

}  // namespace lambent::baker
