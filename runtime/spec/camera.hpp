// Parses cameras and computes their matrices. A camera is written orbit:AZ,EL,DIST,FOV, or as the name or
// index of a camera in the file. With the scene's bounds and the picture's aspect (width / height) it gives a
// View for OpenGL clip space (z in -1..1). Near and far planes are fitted to the bounds, so nothing is cut
// off and depth precision is not wasted. Angles are in degrees, FOV is vertical, and DIST is in
// bounding-sphere radii (half the box's diagonal). The reference renderer traces primary rays through the
// same View, so its pictures can be compared pixel by pixel.
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

// Parses the size of a picture, WIDTHxHEIGHT in pixels, as in --size. Both are in 1..kMaxPictureSide. Errors
// show the expected form.

inline constexpr std::uint32_t kMaxPictureSide = 16384;  // size of textures that OpenGL 4.5 guarantees

struct Size {
  std::uint32_t width = 1280, height = 720;
  float aspect() const { return static_cast<float>(width) / static_cast<float>(height); }
  bool operator==(const Size&) const = default;
};

Result<Size> parseSize(std::string_view word);

// Describes a camera that looks at the centre of the bounds, with +Y up.
struct OrbitCamera {
  float azimuth_deg = 30.0f;    // 0 stands on +Z, 90 on +X
  float elevation_deg = 15.0f;  // above the horizon, -90..90
  float distance_radii = 2.5f;  // > 0
  float fov_deg = 40.0f;        // 0 < fov < 180
};

// Names a camera of the glTF file.
struct NamedCamera {
  std::string name_or_index;
};

using Camera = std::variant<OrbitCamera, NamedCamera>;

// Fails, quoting the word, if its form or a number is wrong.
Result<Camera> parseCamera(std::string_view word);

struct View {
  glm::mat4 view_from_world{1.0f};
  glm::mat4 clip_from_view{1.0f};
  glm::vec3 eye_ws{0.0f};
};

// Returns the default camera. It shows all corners of the scene's box, with a margin, from the open side of
// the scene if there is one. `open_side_ws` is the sum of area times normal over the surfaces, which is 0 for
// closed bodies and points out of a stage or a room without a front wall.
OrbitCamera framingOrbit(glm::vec3 bounds_min_ws, glm::vec3 bounds_max_ws, glm::vec3 open_side_ws,
                         float aspect);

View orbitView(const OrbitCamera& camera, glm::vec3 bounds_min_ws, glm::vec3 bounds_max_ws, float aspect);

// Returns the node that carries the camera. The camera is found by its name, else by the name of its node,
// else by its index. The error lists the cameras of the file.
Result<std::uint32_t> findCameraNode(const std::vector<gltf::Node>& nodes,
                                     const std::vector<gltf::Camera>& cameras, const NamedCamera& wanted);

// Returns the view of a camera of the file. It keeps the vertical field of view (or ymag) and uses the
// picture's aspect. Scale in world_from_node is ignored, as glTF requires. Fails if a field of view or
// magnification is out of range, or if the matrix is singular.
Result<View> cameraView(const gltf::Camera& camera, const glm::mat4& world_from_node, glm::vec3 bounds_min_ws,
                        glm::vec3 bounds_max_ws, float aspect);

}  // namespace lambent::spec
