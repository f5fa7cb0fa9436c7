// Places the eye exactly as lambent-demo does: with the same bounds, the same default and the same View, and
// rays through pixel centres between its near and far planes.
#pragma once

#include <optional>

#include "baker/import/scene.hpp"
#include "reference/ray_tracer.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::baker::reference {

// `nodes_at_rest` give the bounds that orbits use, so that animated nodes do not move the camera. Errors: no
// camera has that name, or one cannot be looked through.
Result<spec::View> viewOf(const Scene& scene, const Surfaces& surfaces,
                          const std::vector<gltf::Node>& nodes_at_rest,
                          const std::optional<spec::Camera>& camera, float aspect);

class EyeRays {
 public:
  EyeRays(const spec::View& view, const spec::Size& size);
  // Row 0 is the top. The far plane is at ray length 1.
  Ray through(std::uint32_t x, std::uint32_t y) const;
  // Returns the depth of a point in the world along the camera's axis, metres.
  double depthOf(const glm::dvec3& point_ws) const;
  // Returns the radians that a pixel spans in the centre, as the runtime's sky uses them.
  float pixelAngle() const { return pixel_angle_rad_; }

 private:
  glm::dmat4 world_from_clip_, view_from_world_;
  spec::Size size_;
  float pixel_angle_rad_;
};

}  // namespace lambent::baker::reference
