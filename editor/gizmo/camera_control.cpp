#include "editor/gizmo/camera_control.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "runtime/spec/light.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::editor {
namespace {

constexpr float kDegreesPerHeight = 180.0f;  // turn by a drag over the whole height
constexpr float kZoomPerNotch = 0.88f;
constexpr float kRadiiPerSecond = 0.7f;
constexpr float kFilled = 0.9f;  // fraction of the picture that a framed box fills
constexpr float kNearestRadii = 1e-4f, kFarthestRadii = 1e4f;

float sizeOf(const scene::Box& bounds) {
  const float radius = bounds.empty() ? 1.0f : bounds.radius();
  return radius > 0.0f ? radius : 1.0f;
}

struct Frame {
  glm::vec3 right, up, back;
};

// The up vector follows the elevation beyond the poles, so that looking straight down needs no special case.
Frame frameOf(const CameraPose& pose) {
  const glm::vec3 back = spec::directionFromAzimuthElevation(pose.azimuth_deg, pose.elevation_deg);
  const glm::vec3 up = spec::directionFromAzimuthElevation(pose.azimuth_deg, pose.elevation_deg + 90.0f);
  return {glm::normalize(glm::cross(up, back)), up, back};
}

void turn(CameraPose& pose, float azimuth_deg, float elevation_deg) {
  pose.azimuth_deg = std::remainder(pose.azimuth_deg + azimuth_deg, 360.0f);
  pose.elevation_deg = std::clamp(pose.elevation_deg + elevation_deg, -90.0f, 90.0f);
}

float tanHalf(const CameraPose& pose) {
  return std::tan(glm::radians(0.5f * std::clamp(pose.fov_deg, 0.01f, 179.0f)));
}

}  // namespace

glm::vec3 CameraPose::eye() const {
  return target_ws + distance_m * spec::directionFromAzimuthElevation(azimuth_deg, elevation_deg);
}

float CameraPose::halfHeight() const {
  return distance_m * tanHalf(*this);
}

CameraPose moved(const CameraPose& pose, const CameraInput& input, const scene::Box& bounds) {
  CameraPose next = pose;
  const float size = sizeOf(bounds), height = std::max(input.height_px, 1.0f);
  const float orbit = kDegreesPerHeight / height;
  turn(next, -orbit * input.orbit_px.x, orbit * input.orbit_px.y);
  if (input.look_px != glm::vec2(0.0f)) {
    const glm::vec3 eye = next.eye();
    const float look = next.fov_deg / height;  // what the camera looks at follows the pointer
    turn(next, -look * input.look_px.x, look * input.look_px.y);
    next.target_ws += eye - next.eye();
  }
  const Frame frame = frameOf(next);
  const float metres = 2.0f * next.halfHeight() / height;
  next.target_ws += metres * (input.pan_px.y * frame.up - input.pan_px.x * frame.right);
  next.distance_m = std::clamp(next.distance_m * std::pow(kZoomPerNotch, input.dolly), kNearestRadii * size,
                               kFarthestRadii * size);
  // The keys for up and down move along the world's up, not the camera's.
  const glm::vec3 way =
      input.fly.x * frame.right + input.fly.y * glm::vec3(0.0f, 1.0f, 0.0f) - input.fly.z * frame.back;
  next.target_ws += kRadiiPerSecond * size * input.fly_speed * input.seconds * way;
  return next;
}

CameraPose eased(const CameraPose& pose, const CameraPose& goal, float seconds, float half_s) {
  const float left = half_s > 0.0f ? std::exp2(-std::max(seconds, 0.0f) / half_s) : 0.0f;
  const float turn_deg = std::remainder(pose.azimuth_deg - goal.azimuth_deg, 360.0f);
  const float ratio = std::log(std::max(pose.distance_m, 1e-12f) / std::max(goal.distance_m, 1e-12f));
  const float away = glm::length(pose.target_ws - goal.target_ws) / std::max(goal.halfHeight(), 1e-12f);
  // The limits are half a line in a picture of 4000 lines for the position, and as little for the others.
  const float rest =
      left * std::max({std::abs(turn_deg) / 90.0f, std::abs(pose.elevation_deg - goal.elevation_deg) / 90.0f,
                       std::abs(ratio), away, std::abs(pose.fov_deg - goal.fov_deg) / 90.0f});
  if (!(rest > 2.5e-4f)) return goal;
  CameraPose next = goal;
  next.target_ws += left * (pose.target_ws - goal.target_ws);
  next.azimuth_deg = std::remainder(goal.azimuth_deg + left * turn_deg, 360.0f);
  next.elevation_deg += left * (pose.elevation_deg - goal.elevation_deg);
  next.distance_m *= std::exp(left * ratio);
  next.fov_deg += left * (pose.fov_deg - goal.fov_deg);
  return next;
}

CameraPose framed(const CameraPose& pose, const scene::Box& box, float aspect) {
  if (box.empty()) return pose;
  CameraPose next = pose;
  next.target_ws = box.center();
  const Frame frame = frameOf(pose);
  const glm::vec3 half = 0.5f * (box.max - box.min);
  const float fitting = kFilled * tanHalf(pose);
  float distance = 0.0f;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 place =
        half * glm::vec3(corner & 1 ? 1.0f : -1.0f, corner & 2 ? 1.0f : -1.0f, corner & 4 ? 1.0f : -1.0f);
    const float reach = std::max(std::abs(glm::dot(place, frame.up)),
                                 std::abs(glm::dot(place, frame.right)) / std::max(aspect, 1e-3f)) /
                        fitting;
    const float depth = glm::dot(place, frame.back);
    // Without perspective nearer corners look no larger, so the eye only has to be in front of them.
    distance = std::max(distance, pose.orthographic ? std::max(reach, 1.01f * depth) : depth + reach);
  }
  if (distance > 0.0f) next.distance_m = distance;  // a point keeps the present distance
  return next;
}

spec::View viewOf(const CameraPose& pose, const scene::Box& bounds, float aspect) {
  gltf::Camera camera;
  camera.name = "editor";
  camera.perspective = !pose.orthographic;
  camera.yfov_rad = glm::radians(std::clamp(pose.fov_deg, 0.01f, 179.0f));
  camera.ymag = pose.halfHeight();
  camera.xmag = camera.ymag * aspect;
  const scene::Box seen = bounds.empty() ? scene::Box{pose.target_ws, pose.target_ws} : bounds;
  return spec::cameraView(camera, nodeMatrix(pose), seen.min, seen.max, aspect).value_or(spec::View{});
}

// ---- Words.

CameraPose fromOrbit(const spec::OrbitCamera& orbit, const scene::Box& bounds) {
  CameraPose pose;
  pose.target_ws = bounds.empty() ? glm::vec3(0.0f) : bounds.center();
  pose.azimuth_deg = orbit.azimuth_deg;
  pose.elevation_deg = orbit.elevation_deg;
  pose.distance_m = orbit.distance_radii * sizeOf(bounds);
  pose.fov_deg = orbit.fov_deg;
  return pose;
}

glm::mat4 nodeMatrix(const CameraPose& pose) {
  const Frame frame = frameOf(pose);
  return glm::mat4(glm::vec4(frame.right, 0.0f), glm::vec4(frame.up, 0.0f), glm::vec4(frame.back, 0.0f),
                   glm::vec4(pose.eye(), 1.0f));
}

CameraPose fromNode(const glm::mat4& world_from_node, const scene::CameraComponent& camera,
                    const scene::Box& bounds) {
  CameraPose pose;
  const glm::vec3 eye(world_from_node[3]), up(world_from_node[1]);
  glm::vec3 back(world_from_node[2]);
  if (!(glm::length(back) > 0.0f)) return pose;
  back = glm::normalize(back);
  pose.elevation_deg = glm::degrees(std::asin(std::clamp(back.y, -1.0f, 1.0f)));
  // When the camera looks straight up or down, the azimuth is that of its up vector.
  const bool pole = std::abs(back.y) > 0.99999f;
  const glm::vec3 across = !pole ? back : back.y > 0.0f ? -up : up;
  pose.azimuth_deg = glm::degrees(std::atan2(across.x, across.z));
  const float size = sizeOf(bounds);
  const float depth = bounds.empty() ? size : glm::dot(eye - bounds.center(), back);
  pose.distance_m = depth > 0.01f * size ? depth : size;
  pose.target_ws = eye - pose.distance_m * back;
  pose.orthographic = !camera.perspective;
  pose.fov_deg =
      glm::degrees(camera.perspective ? camera.yfov_rad : 2.0f * std::atan(camera.ymag / pose.distance_m));
  return pose;
}

std::string poseWord(const CameraPose& pose) {
  return fmt::format("pose:{},{},{},{},{},{},{}{}", pose.target_ws.x, pose.target_ws.y, pose.target_ws.z,
                     pose.azimuth_deg, pose.elevation_deg, pose.distance_m, pose.fov_deg,
                     pose.orthographic ? ",ortho" : "");
}

Result<CameraPose> parsePose(std::string_view word) {
  constexpr std::string_view kStart = "pose:", kOrtho = ",ortho";
  const std::string subject = fmt::format("camera \"{}\"", word);
  const std::string form = "write pose:X,Y,Z,AZ,EL,DISTANCE,FOV or the same with ,ortho";
  if (!word.starts_with(kStart)) return fail(subject, "is no pose", form);
  word.remove_prefix(kStart.size());
  CameraPose pose;
  pose.orthographic = word.ends_with(kOrtho);
  if (pose.orthographic) word.remove_suffix(kOrtho.size());
  const auto numbers = spec::parseNumbers(word);
  if (!numbers || numbers->size() != 7) return fail(subject, "needs seven numbers", form);
  const auto& n = *numbers;
  pose.target_ws = {n[0], n[1], n[2]};
  pose.azimuth_deg = n[3];
  pose.elevation_deg = n[4];
  pose.distance_m = n[5];
  pose.fov_deg = n[6];
  if (std::abs(pose.elevation_deg) > 90.0f) return fail(subject, "has an elevation outside -90..90", form);
  if (!(pose.distance_m > 0.0f)) return fail(subject, "has a distance that is not above 0", form);
  if (pose.fov_deg < 0.01f || pose.fov_deg > 179.0f)
    return fail(subject, "has a field of view outside 0.01..179", form);
  return pose;
}

}  // namespace lambent::editor
