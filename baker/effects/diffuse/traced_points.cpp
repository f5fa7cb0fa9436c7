#include "baker/effects/diffuse/traced_points.hpp"

#include <utility>

namespace lambent::baker {

TracedPoints::TracedPoints(const TracedScene& scene, FacePoints points, const DirectSettings& settings)
    : points_(std::move(points)), scene_(scene.withSamples(points_.samples)), pass_(scene_, settings) {}

bool TracedPoints::look(const BakeContext& context, const char* stage) {
  auto found = bakeDirect(pass_, scene_, context, stage);
  if (!found) return false;
  direct_ = std::move(*found);
  return true;
}

}  // namespace lambent::baker
