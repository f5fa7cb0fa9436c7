// Moves the editor's own camera: around a point (orbit, pan, dolly), on foot (look, fly), and onto a
// selection (frame). All functions are pure: a pose and a movement of the pointer give a pose, so that
// scripts and tests move it as a hand does. Speeds count in the size of the scene, so that a teacup and a
// city feel alike. A pose goes to and from orbit words, and makes a spec::View like any other camera's.
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

// Looks from the eye, which stands at `distance_m` in the direction (azimuth, elevation), at the target. Up
// is +Y, or follows the elevation beyond the poles.
struct CameraPose {
  glm::vec3 target_ws{0.0f};
  float azimuth_deg = 30.0f, elevation_deg = 15.0f;  // as spec::OrbitCamera; -90..90
  float distance_m = 5.0f;                           // > 0
  float fov_deg = 40.0f;                             // vertical
  // The picture's half height is then what the perspective view shows at the target.
  bool orthographic = false;
  bool operator==(const CameraPose&) const = default;

  glm::vec3 eye() const;
  float halfHeight() const;  // metres at the target
};

// Tells what the hand did since the last time.
struct CameraInput {
  glm::vec2 orbit_px{0.0f};  // pointer, right and down: about the target
  glm::vec2 look_px{0.0f};   // about the eye
  glm::vec2 pan_px{0.0f};    // the target's plane follows the pointer to the pixel
  float dolly = 0.0f;        // notches of the wheel, positive: nearer
  glm::vec3 fly{0.0f};       // right, up, forward, each -1..1: keys that are held
  float fly_speed = 1.0f;    // factor: a modifier key, the wheel
  float seconds = 0.0f;      // that the keys were held
  float height_px = 1.0f;    // of the viewport
};

// Returns the pose after the movement. bounds: the scene's; empty ones count as a metre.
CameraPose moved(const CameraPose& pose, const CameraInput& input, const scene::Box& bounds);

// Moves nearer to the goal by half in every half_s, and to it once no pixel would tell. Turns by the shorter
// way.
CameraPose eased(const CameraPose& pose, const CameraPose& goal, float seconds, float half_s = 0.06f);

// Lets the box fill the picture, seen from the same direction. Empty boxes change nothing.
CameraPose framed(const CameraPose& pose, const scene::Box& box, float aspect);

// Makes a view whose depth is fitted to the bounds.
spec::View viewOf(const CameraPose& pose, const scene::Box& bounds, float aspect);

// ---- words
CameraPose fromOrbit(const spec::OrbitCamera& orbit, const scene::Box& bounds);
// Returns the orbit that stands at the same place and looks at the bounds' centre: the same picture if the
// pose looks there.
spec::OrbitCamera toOrbit(const CameraPose& pose, const scene::Box& bounds);
bool isOrbit(const CameraPose& pose, const scene::Box& bounds);
std::string orbitWord(const spec::OrbitCamera& orbit);  // "orbit:30,15,2.5,40"
// Takes a camera of a file: its place and direction (its roll is lost), looking at the depth of the bounds'
// centre.
CameraPose fromNode(const glm::mat4& world_from_node, const scene::CameraComponent& camera,
                    const scene::Box& bounds);
// Returns the matrix of a node that looks as the pose does: "camera from view".
glm::mat4 nodeMatrix(const CameraPose& pose);

// Writes "pose:X,Y,Z,AZ,EL,DISTANCE,FOV[,ortho]", for WorldState::view, and reads it back.
std::string poseWord(const CameraPose& pose);
Result<CameraPose> parsePose(std::string_view word);

}  // namespace lambent::editor
