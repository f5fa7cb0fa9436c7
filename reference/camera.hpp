// Finds the view of a picture exactly as lambent-demo does, with the same bounds, default camera and
// projection, and makes rays through pixel centres.
#pragma once

#include <optional>
#include <vector>

#include "baker/import/scene.hpp"
#include "reference/ray_tracer.hpp"
#include "reference/volumes.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/camera.hpp"

namespace lambent::baker::reference {

// Orbit cameras use the bounds of `nodes_at_rest`, so that animated nodes do not move the camera. Errors: no
// camera has that name, or its node or projection is unusable.
Result<spec::View> viewOf(const Scene& scene, const Surfaces& surfaces,
                          const std::vector<gltf::Node>& nodes_at_rest,
                          const std::optional<spec::Camera>& camera, float aspect);

class EyeRays {
 public:
  EyeRays(const spec::View& view, const spec::Size& size);
  // Returns the ray through a pixel's centre. Row 0 is the top. The ray starts on the near plane; the far
  // plane is at ray length 1.
  Ray through(std::uint32_t x, std::uint32_t y) const;
  // Returns the depth of a point along the camera's axis, in metres.
  double depthOf(const glm::dvec3& point_ws) const;
  // Returns the angle of a pixel at the centre of the picture, in radians, as the runtime computes it for its
  // sky.
  float pixelAngle() const { return pixel_angle_rad_; }

 private:
  glm::dmat4 world_from_clip_, view_from_world_;
  spec::Size size_;
  float pixel_angle_rad_;
};

// Integrates the optical depth of the media along one ray from the eye, exactly: between the planes of voxel
// centres, density along the ray is a cubic, which two-point Gauss quadrature integrates exactly. Coverage is
// therefore free of noise, and points that scatter light to the eye can be sampled uniformly. Optical depth
// counts from `begin`. The volumes must outlive this.

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
