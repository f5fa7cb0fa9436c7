// Where the eye is, exactly as lambent-demo has it: the same bounds, the same default, the same View, rays
// through pixel centres between its near and far planes.
#pragma once

#include <optional>

#include "baker/import/scene.hpp"
#include "reference/ray_tracer.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::baker::reference {

// Errors: no camera of that name; one that cannot be looked through.
// nodes_at_rest: by which orbits stand; what moves in a scene does not move its camera.
Result<spec::View> viewOf(const Scene& scene, const Surfaces& surfaces,
                          const std::vector<gltf::Node>& nodes_at_rest,
                          const std::optional<spec::Camera>& camera, float aspect);

class EyeRays {
 public:
  EyeRays(const spec::View& view, const spec::Size& size);
  // Row 0 is the top. The ray's length 1 is the far plane.
  Ray through(std::uint32_t x, std::uint32_t y) const;
  // Of a point of the world along the camera's axis, metres.
  double depthOf(const glm::dvec3& point_ws) const;
  // Radians that a pixel spans in the middle, as the runtime's sky has it.
  float pixelAngle() const { return pixel_angle_rad_; }

 private:
  glm::dmat4 world_from_clip_, view_from_world_;
  spec::Size size_;
  float pixel_angle_rad_;
};

}  // namespace lambent::baker::reference
