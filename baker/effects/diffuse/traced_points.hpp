// Traces direct light at points of surfaces that are no vertices, as at vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/effects/diffuse/direct.hpp"
#include "baker/trace/vertex_fit.hpp"
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

// Holds diffuse samples inside the faces over which light changes, with and without normal maps. The values
// at vertices are fitted to what arrives there (trace/vertex_fit.hpp): direct light, and what bounces bring.

// Returns, in ascending order, the triangles of diffuse draws over which light may change much: those over
// which `direct` does, the direct light of all samples, and large ones to which mostly bounced light comes.
// Colours have no say, so that after a change of colours no ray is traced again.
std::vector<std::uint32_t> changingDiffuse(const TracedScene& scene, const TransferField& direct);

class DiffuseInsideFaces {
 public:
  // Places one sample in each triangle. Rays are as many as those of `vertices`; their hits are kept as far
  // as `hit_memory` bytes allow. `scene` holds the vertices' samples, and all that it refers to must outlive
  // this.
  DiffuseInsideFaces(const DirectPass& vertices, const TracedScene& scene,
                     std::span<const std::uint32_t> triangles, std::size_t hit_memory);

  // Traces direct light at the points. The key of the context covers the vertices' rays and the triangles.
  // Returns false if stopped.
  bool look(const BakeContext& context);

  const TracedPoints& points() const { return points_; }
  TracedPoints& points() { return points_; }

  // Corrects diffuse transfer of all samples, or that of normal-mapped ones for any normal, by how far
  // interpolation is off at the points. A fit may overshoot, so a sample is corrected only as far as it stays
  // between 0 and `most` under uniform light of radiance 1. Returns false if stopped.
  bool fit(const TransferField& at_points, float most, TransferField& at_vertices,
           const std::stop_token& stop) const;
  bool fitMapped(const TransferField& at_points, TransferField& at_vertices,
                 const std::stop_token& stop) const;

 private:
  const TracedScene vertices_;
  TracedPoints points_;
  std::optional<VertexFit> plain_, mapped_;
};

}  // namespace lambent::baker
