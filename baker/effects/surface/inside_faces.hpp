// Traces light at points of surfaces that are no vertices, as at vertices; and fits what vertices have to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/effects/surface/direct.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// Fits values at vertices so that linear interpolation over faces comes closest to the transfer on the faces,
// by least squares (Kavan, Bargteil and Sloan 2011, "Least Squares Vertex Baking"): they minimise
//   ∫ |sum_i phi_i(x) v_i - T(x)|² dx.
// Taking T at the vertices themselves errs to one side wherever transfer curves. The integral over a triangle
// is exact for polynomials of degree two: each corner has the weight 1/12, the centroid 3/4. Triangles
// without a point count as if interpolation were right there, so that values stay as they are far from all
// points and where neighbours see the same. Constants are reproduced exactly.

// Returns, in ascending order, the triangles over which values change: those with most of the squared change
// between corners. `values` is [sample of the stretch][width].
std::vector<std::uint32_t> changingTriangles(const GroupGeometry& geometry, const SampleSet& samples,
                                             SampleStretch stretch, std::size_t width,
                                             std::span<const float> values);

class VertexFit {
 public:
  // `valid` has an entry for each of the points; invalid points do not count. `points_stretch` is the range
  // of FacePoints::samples with the points of the stretch's kind.
  VertexFit(const GroupGeometry& geometry, const SampleSet& samples, SampleStretch stretch,
            const FacePoints& points, SampleStretch points_stretch, std::span<const std::uint8_t> valid);
  ~VertexFit();

  // Corrects `values`, [sample of the stretch][width], by how far interpolation is off `at_points`, [point of
  // its stretch][width]. Returns false if stopped. The result does not depend on the number of threads.
  bool apply(std::size_t width, std::span<const float> at_points, std::span<float> values,
             const std::stop_token& stop) const;

 private:
  struct System;
  std::unique_ptr<const System> system_;
};

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
  const DirectPass& pass() const { return pass_; }  // its samples are the points, starting at 0

  DirectResult direct;
  TransferField bounced;  // what all passes of bounces bring; that of glossy points is in direct.glossy

 private:
  FacePoints points_;
  TracedScene scene_;
  DirectPass pass_;
};

// Holds points of one part inside the faces over which light changes. The values at vertices are fitted to
// what arrives there (VertexFit): direct light, and what every pass of bounces brings.
class InsideFaces {
 public:
  // Places one sample in each triangle; all must belong to draws of the part. Rays are as many as those of
  // `vertices`; their hits are kept as far as `hit_memory` bytes allow.
  InsideFaces(const DirectPass& vertices, SurfacePart part, std::span<const std::uint32_t> triangles,
              std::size_t hit_memory);

  // Traces direct light at the points. The key of the context covers the vertices' rays and the triangles.
  // Returns false if stopped.
  bool look(const BakeContext& context);

  SurfacePart part() const { return part_; }
  const TracedPoints& points() const { return points_; }
  TracedPoints& points() { return points_; }

  // Corrects direct light of the part at vertices. Returns false if stopped, as all fits do.
  bool fitDirect(DirectResult& at_vertices, const std::stop_token& stop);
  // Corrects diffuse transfer of all matte samples by how far interpolation is off at the points. A fit may
  // overshoot, so a sample is corrected only as far as it stays between 0 and `most` under uniform light of
  // radiance 1.
  bool fit(const TransferField& at_points, float most, TransferField& at_vertices,
           const std::stop_token& stop) const;
  // Corrects what a stretch of samples has, normal-mapped or glossy ones, with any number of values for each
  // sample.
  bool fit(SampleKind kind, std::span<const float> at_points, std::span<float> at_vertices,
           const std::stop_token& stop) const;

 private:
  const TracedScene vertices_;
  SurfacePart part_;
  TracedPoints points_;
  // Indexed by the kind of sample (diffuse, normal-mapped, glossy); set where there are points of the kind.
  std::array<std::optional<VertexFit>, 3> fits_;
};

// Fits direct light of a part at vertices so that interpolation over faces shows it best: it traces rays from
// inside the faces over which light changes, and fits the vertices to what they see by least squares. Leaves
// `inside` null where it changes nowhere. The key of the context is that of the rays of the vertices. Returns
// false if stopped. The result does not depend on the number of threads.
bool fitInsideFaces(const DirectPass& vertices, SurfacePart part, const BakeContext& context,
                    DirectResult& direct, std::unique_ptr<InsideFaces>& inside);

}  // namespace lambent::baker
