// Integrates the media along one ray from the eye, without noise: between the planes of voxel centres,
// density along a ray is a cubic, whose integral two points give exactly. So coverage is exact, and places
// that scatter light towards the eye can be drawn evenly. Optical depth counts from the eye. The volumes must
// outlive this.
#pragma once

#include <vector>

#include "reference/volumes.hpp"

namespace lambent::baker::reference {

class EyeDepth {
 public:
  // Covers the ray from `begin` to `end`, in lengths of its direction.
  EyeDepth(const Volumes& volumes, const Ray& ray, double begin, double end);

  // Returns the optical depth from the beginning to t.
  double to(double t) const;
  // Returns the t that has this depth before it. It must lie inside a medium.
  double place(double depth) const;
  // Returns the volume that scatters at t; `choice` in [0, 1) picks by shares of the extinction.
  std::uint32_t pick(double t, double choice) const;

 private:
  struct Part {
    GridRay ray;
    std::uint32_t volume;
  };
  struct Segment {
    double begin, end, depth;  // depth is that before the segment
  };
  // Returns the extinction of all volumes that cover `middle`, per t.
  double extinction(double t, double middle) const;
  double within(const Segment& segment, double t) const;

  const Volumes& volumes_;
  std::vector<Part> parts_;
  std::vector<Segment> segments_;  // segments that are not empty, in order
  double whole_ = 0.0;
};

}  // namespace lambent::baker::reference
