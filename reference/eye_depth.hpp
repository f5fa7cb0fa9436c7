// Integrates the optical depth of the media along one ray from the eye, exactly: between the planes of voxel
// centres, density along the ray is a cubic, which two-point Gauss quadrature integrates exactly. Coverage is
// therefore free of noise, and points that scatter light to the eye can be sampled uniformly. Optical depth
// counts from `begin`. The volumes must outlive this.
#pragma once

#include <vector>

#include "reference/volumes.hpp"

namespace lambent::baker::reference {

class EyeDepth {
 public:
  // Covers the ray from `begin` to `end`, in units of its direction's length.
  EyeDepth(const Volumes& volumes, const Ray& ray, double begin, double end);

  // Returns the optical depth between `begin` and t.
  double to(double t) const;
  // Returns the t with this optical depth before it, which is inside a medium.
  double place(double depth) const;
  // Selects the volume that scatters at t in proportion to the extinction; `choice` is in [0, 1).
  std::uint32_t pick(double t, double choice) const;

 private:
  struct Part {
    GridRay ray;
    std::uint32_t volume;
  };
  struct Segment {
    double begin, end, depth;  // depth: the optical depth before the segment
  };
  // Returns the extinction per t at t, of the volumes that cover the point `middle`.
  double extinction(double t, double middle) const;
  double within(const Segment& segment, double t) const;

  const Volumes& volumes_;
  std::vector<Part> parts_;
  std::vector<Segment> segments_;  // the segments with a medium, in order
  double whole_ = 0.0;
};

}  // namespace lambent::baker::reference
