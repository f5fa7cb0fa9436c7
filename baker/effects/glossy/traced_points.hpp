// Traces direct light at points of glossy surfaces that are no vertices, as at vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/effects/glossy/glossy_direct.hpp"
#include "baker/trace/vertex_fit.hpp"
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

// Holds glossy samples inside the faces over which direct light changes. The values at vertices are fitted to
// what arrives there, directly and in every pass of bounces (trace/vertex_fit.hpp).

class GlossyInsideFaces {
 public:
  // Places one sample in each triangle; all triangles must belong to glossy draws. Rays and orders are those
  // of `vertices`, which must outlive this.
  GlossyInsideFaces(const GlossyPass& vertices, std::span<const std::uint32_t> triangles);

  // Traces direct light at the points, before anything is fitted, and returns it; the hits stay here.
  // Returns nothing if stopped.
  std::optional<GlossyField> look(std::size_t hit_memory, const BakeContext& context);

  const TracedGlossyPoints& points() const { return points_; }
  TracedGlossyPoints& points() { return points_; }

  // Corrects values at vertices by how far interpolation between them is off at the points. Both have the
  // same number of values for each sample, possibly none. Returns false if stopped.
  bool fit(std::span<const float> at_points, std::span<float> at_vertices, const std::stop_token& stop) const;

 private:
  const GlossyPass& vertices_;
  TracedGlossyPoints points_;
  std::optional<VertexFit> fit_;
};

}  // namespace lambent::baker
