// The media along one ray from the eye, without noise: density between the planes of voxel centres is a cubic
// along a ray, whose integral two points give exactly. So coverage is exact, and where light is scattered
// towards the eye can be drawn evenly. Optical depth counts from the eye. The volumes must outlive it.
#pragma once

#include <vector>

#include "reference/volumes.hpp"

namespace lambent::baker::reference {

class EyeDepth {
 public:
  // From `begin` to `end`, in lengths of the ray's direction.
  EyeDepth(const Volumes& volumes, const Ray& ray, double begin, double end);

  // Between the beginning and t.
  double to(double t) const;
  // The place with that depth before it, which must lie inside a medium.
  double place(double depth) const;
  // Whose medium scatters there: `choice` in [0, 1) picks by their shares of the extinction.
  std::uint32_t pick(double t, double choice) const;

 private:
  struct Part {
    GridRay ray;
    std::uint32_t volume;
  };
  struct Segment {
    double begin, end, depth;  // depth: before it
  };
  // Of all volumes that cover `middle`, per t.
  double extinction(double t, double middle) const;
  double within(const Segment& segment, double t) const;

  const Volumes& volumes_;
  std::vector<Part> parts_;
  std::vector<Segment> segments_;  // those with something in them, in order
  double whole_ = 0.0;
};

}  // namespace lambent::baker::reference
