// Traces direct light at points of surfaces that are no vertices, as at vertices.
#pragma once

#include <cstddef>

#include "baker/effects/diffuse/direct.hpp"
#include "baker/transport/face_points.hpp"

namespace lambent::baker {

class TracedPoints {
 public:
  // All that `scene` refers to, but for its samples, must outlive this.
  TracedPoints(const TracedScene& scene, FacePoints points, const DirectSettings& settings);
  TracedPoints(const TracedPoints&) = delete;  // its pass refers to its points
  TracedPoints& operator=(const TracedPoints&) = delete;

  // Traces direct light. The key of the context covers the rays and the points; `stage` is the name that
  // progress shows. Returns false if stopped.
  bool look(const BakeContext& context, const char* stage);

  std::size_t size() const { return points_.samples.size(); }
  const FacePoints& points() const { return points_; }
  const TracedScene& scene() const { return scene_; }  // its samples are the points, starting at 0
  const DirectPass& pass() const { return pass_; }
  const DirectResult& direct() const { return direct_; }
  DirectResult& direct() { return direct_; }

 private:
  FacePoints points_;
  TracedScene scene_;
  DirectPass pass_;
  DirectResult direct_;
};

}  // namespace lambent::baker
