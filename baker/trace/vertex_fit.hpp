// Fits values at vertices so that linear interpolation over faces comes closest to the transfer on the faces,
// by least squares (Kavan, Bargteil and Sloan 2011, "Least Squares Vertex Baking"): they minimise
//   ∫ |sum_i phi_i(x) v_i - T(x)|² dx.
// Taking T at the vertices themselves errs to one side wherever transfer curves. The integral over a triangle
// is exact for polynomials of degree two: each corner has the weight 1/12, the centroid 3/4. Triangles
// without a point count as if interpolation were right there, so that values stay as they are far from all
// points and where neighbours see the same. Constants are reproduced exactly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "baker/transport/face_points.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

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

}  // namespace lambent::baker
