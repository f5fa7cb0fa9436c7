// Moves the editor's own camera: around a point (orbit, pan, dolly), freely (look, fly), and onto a selection
// (frame). All functions are pure: they take a pose and an input and return a pose, so scripts and tests can
// drive them. Speeds scale with the size of the scene. A pose converts to and from orbit words, and to a
// spec::View.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/spec/camera.hpp"

namespace lambent::editor {

// Describes a camera that looks at a target from `distance_m` in the direction (azimuth, elevation). Its up
// vector is +Y, and follows the elevation beyond the poles.
struct CameraPose {
  glm::vec3 target_ws{0.0f};
  float azimuth_deg = 30.0f, elevation_deg = 15.0f;  // as spec::OrbitCamera; -90..90
  float distance_m = 5.0f;                           // > 0
  float fov_deg = 40.0f;                             // vertical
  // Sets an orthographic projection, whose half height is what the perspective view shows at the target's
  // distance.
  bool orthographic = false;
  bool operator==(const CameraPose&) const = default;

  glm::vec3 eye() const;
  float halfHeight() const;  // in metres, at the target
};

// Describes the user's input since the last call.
struct CameraInput {
  glm::vec2 orbit_px{0.0f};  // pointer movement to the right and down, which orbits the target
  glm::vec2 look_px{0.0f};   // pointer movement that turns the camera about the eye
  glm::vec2 pan_px{0.0f};    // pointer movement that pans; the target's plane follows the pointer exactly
  float dolly = 0.0f;        // notches of the wheel; positive moves nearer
  glm::vec3 fly{0.0f};       // held keys: right, up, forward, each -1..1
  float fly_speed = 1.0f;    // a factor, from a modifier key or the wheel
  float seconds = 0.0f;      // how long the keys were held
  float height_px = 1.0f;    // of the viewport
};

// Returns the pose after the input. bounds: those of the scene; empty ones count as one metre.
CameraPose moved(const CameraPose& pose, const CameraInput& input, const scene::Box& bounds);

// Halves the difference to the goal every half_s seconds and returns the goal once the rest is below a pixel.
// Angles take the shorter way round.
CameraPose eased(const CameraPose& pose, const CameraPose& goal, float seconds, float half_s = 0.06f);

// Returns a pose that fits the box into the picture without turning. An empty box changes nothing.
CameraPose framed(const CameraPose& pose, const scene::Box& box, float aspect);

// Returns a view whose near and far plane fit the bounds.
spec::View viewOf(const CameraPose& pose, const scene::Box& bounds, float aspect);

// ---- Conversions.
CameraPose fromOrbit(const spec::OrbitCamera& orbit, const scene::Box& bounds);
// Converts a camera node of a file. The roll is lost, and the target is put at the depth of the bounds'
// centre.
CameraPose fromNode(const glm::mat4& world_from_node, const scene::CameraComponent& camera,
                    const scene::Box& bounds);
glm::mat4 nodeMatrix(const CameraPose& pose);

// Convert a pose to "pose:X,Y,Z,AZ,EL,DISTANCE,FOV[,ortho]", for WorldState::view, and back.
std::string poseWord(const CameraPose& pose);
Result<CameraPose> parsePose(std::string_view word);

}  // namespace lambent::editor
