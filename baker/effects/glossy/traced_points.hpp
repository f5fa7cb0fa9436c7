// Traces direct light at points of glossy surfaces that are no vertices, as at vertices.
#pragma once

#include <cstddef>

#include "baker/effects/glossy/glossy_direct.hpp"
#include "baker/transport/face_points.hpp"

namespace lambent::baker {

class TracedGlossyPoints {
 public:
  // All points are glossy, and matrices have `order_out` bands. All that `scene` refers to, but for its
  // samples, must outlive this.
  TracedGlossyPoints(const TracedScene& scene, FacePoints points, const DirectSettings& settings,
                     int order_out);
  TracedGlossyPoints(const TracedGlossyPoints&) = delete;  // its passes refer to its points
  TracedGlossyPoints& operator=(const TracedGlossyPoints&) = delete;

  // Traces direct light; hits are kept as far as `hit_memory` bytes allow. Context and stage are as in
  // bakeDirect. Returns false if stopped.
  bool look(std::size_t hit_memory, const BakeContext& context, const char* stage);

  std::size_t size() const { return points_.samples.size(); }
  const FacePoints& points() const { return points_; }
  const GlossyPass& pass() const { return pass_; }  // its samples are the points, starting at 0
  const SampleVisibilities& looks() const { return looks_; }
  const GlossyDirect& direct() const { return direct_; }
  GlossyDirect& direct() { return direct_; }

 private:
  FacePoints points_;
  TracedScene scene_;
  DirectPass plain_;
  GlossyPass pass_;
  SampleVisibilities looks_;
  GlossyDirect direct_;
};

}  // namespace lambent::baker
