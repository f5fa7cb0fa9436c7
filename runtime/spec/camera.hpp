// The words for cameras and the matrices that follow from them. Comes in: orbit:AZ,EL,DIST,FOV or the name or
// index of a camera in the file; the scene's bounds; the picture's aspect (width / height). Goes out: a View
// for OpenGL clip space (z in -1..1), whose near and far planes are fitted to the bounds, so that nothing in
// them is cut off and depth is spent on what is there. Angles in degrees, FOV vertical, DIST in
// bounding-sphere radii (half the box's diagonal). The reference renderer traces primary rays through the
// same View, so pictures of both can be compared texel by texel.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/bundle/gltf_types.hpp"

namespace lambent::spec {

// Looks at the centre of the bounds; up is +Y.
struct OrbitCamera {
  float azimuth_deg = 30.0f;    // 0 stands on +Z, 90 on +X
  float elevation_deg = 15.0f;  // above the horizon, -90..90
  float distance_radii = 2.5f;  // > 0
  float fov_deg = 40.0f;        // 0 < fov < 180
};

// A camera of the file.
struct NamedCamera {
  std::string name_or_index;
};

using Camera = std::variant<OrbitCamera, NamedCamera>;

Result<Camera> parseCamera(std::string_view word);

struct View {
  glm::mat4 view_from_world{1.0f};
  glm::mat4 clip_from_view{1.0f};
  glm::vec3 eye_ws{0.0f};
};

// Where nothing else is asked for: from the side to which a scene is open, if it is, and so that the corners
// of its box lie within the picture, with a margin. open_side_ws: the sum of area times normal over its
// surfaces, which is 0 for closed bodies and looks out of a stage or a room without a front.
OrbitCamera framingOrbit(glm::vec3 bounds_min_ws, glm::vec3 bounds_max_ws, glm::vec3 open_side_ws,
                         float aspect);

View orbitView(const OrbitCamera& camera, glm::vec3 bounds_min_ws, glm::vec3 bounds_max_ws, float aspect);

// The node that carries the camera: by the camera's name, else the name of its node, else the camera's index.
// Errors list the cameras that there are.
Result<std::uint32_t> findCameraNode(const std::vector<gltf::Node>& nodes,
                                     const std::vector<gltf::Camera>& cameras, const NamedCamera& wanted);

// The vertical field of view (or ymag) is kept and the picture's aspect used; scale in world_from_node is
// ignored, as glTF asks. Errors: a field of view or magnification outside its range, a matrix that is
// singular.
Result<View> cameraView(const gltf::Camera& camera, const glm::mat4& world_from_node, glm::vec3 bounds_min_ws,
                        glm::vec3 bounds_max_ws, float aspect);

}  // namespace lambent::spec
