// Finds the view of a picture exactly as lambent-demo does, with the same bounds, default camera and
// projection, and makes rays through pixel centres.
#pragma once

#include <optional>

#include "baker/import/scene.hpp"
#include "reference/ray_tracer.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/size.hpp"

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

}  // namespace lambent::baker::reference
