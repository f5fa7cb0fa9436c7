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

}  // namespace lambent::baker
