// The values at vertices with which linear interpolation over faces comes closest to the transfer that the
// faces have, by least squares (Kavan, Bargteil and Sloan 2011, "Least Squares Vertex Baking"):
//   minimise  ∫ |sum_i phi_i(x) v_i - T(x)|² dx,
// in place of T at the vertices themselves, which errs to one side wherever transfer curves. The integral
// over a triangle is that of polynomials of degree two: a twelfth for each corner, three quarters for the
// centroid. Triangles without a point count as if interpolation had been right there, so that far from all
// points, and where neighbours see the same, values stay what they were. Constants go through exactly.
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

// Triangles over which values change, ascending: those that have most of the square of all change between
// corners. values: [sample of the stretch][width].
std::vector<std::uint32_t> changingTriangles(const GroupGeometry& geometry, const SampleSet& samples,
                                             SampleStretch stretch, std::size_t width,
                                             std::span<const float> values);

class VertexFit {
 public:
  // valid: of each of the points; others do not count. The points of the stretch's kind are `points_stretch`
  // of FacePoints::samples.
  VertexFit(const GroupGeometry& geometry, const SampleSet& samples, SampleStretch stretch,
            const FacePoints& points, SampleStretch points_stretch, std::span<const std::uint8_t> valid);
  ~VertexFit();

  // Changes values, [sample of the stretch][width], by what they are off at_points, [point of its
  // stretch][width]. False if stopped. The result does not depend on the number of threads.
  bool apply(std::size_t width, std::span<const float> at_points, std::span<float> values,
             const std::stop_token& stop) const;

 private:
  struct System;
  std::unique_ptr<const System> system_;
};

}  // namespace lambent::baker
