#include "runtime/spec/camera.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "runtime/spec/light.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::spec {

Result<Size> parseSize(std::string_view word) {
  Size size;
  const char* const end = word.data() + word.size();
  const auto [cross, width_code] = std::from_chars(word.data(), end, size.width);
  const bool has_cross = width_code == std::errc{} && cross != end && *cross == 'x';
  const auto [stop, height_code] = std::from_chars(has_cross ? cross + 1 : end, end, size.height);
  const std::string subject = "size \"" + std::string(word) + "\"";
  const std::string form = "write WIDTHxHEIGHT in pixels, each 1.." + std::to_string(kMaxPictureSide);
  if (!has_cross || height_code != std::errc{} || stop != end)
    return fail(subject, "is not a picture size", form);
  if (size.width < 1 || size.height < 1 || size.width > kMaxPictureSide || size.height > kMaxPictureSide)
    return fail(subject, "is out of range", form);
  return size;
}

namespace {

struct DepthRange {
  float near_m, far_m;
};

// Returns the range of depths of the bounds along the view, slightly widened. The near plane is at least far
// / 4096 away, so an eye inside the scene keeps enough depth precision and cuts off only what is closer than
// that.
DepthRange fitDepth(const glm::mat4& view_from_world, glm::vec3 bounds_min, glm::vec3 bounds_max) {
  float nearest = std::numeric_limits<float>::max(), farthest = 0.0f;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 point((corner & 1) ? bounds_max.x : bounds_min.x,
                          (corner & 2) ? bounds_max.y : bounds_min.y,
                          (corner & 4) ? bounds_max.z : bounds_min.z);
    const float depth = -(view_from_world * glm::vec4(point, 1.0f)).z;
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  if (!(farthest > 0.0f)) return {0.01f, 1.0f};  // nothing is in front of the eye
  farthest *= 1.01f;
  return {std::max(nearest * 0.99f, farthest / 4096.0f), farthest};
}

std::string known(const std::vector<gltf::Camera>& cameras) {
  if (cameras.empty()) return "the file has no cameras; use orbit:AZ,EL,DIST,FOV";
  std::string list = "choose one of";
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    list += (i ? ", " : " ") + std::to_string(i);
    if (!cameras[i].name.empty()) list += " (" + cameras[i].name + ")";
  }
  return list + " or orbit:AZ,EL,DIST,FOV";
}

}  // namespace

Result<Camera> parseCamera(std::string_view word) {
  constexpr std::string_view kOrbit = "orbit:";
  const std::string subject = "camera \"" + std::string(word) + "\"";
  if (word.empty()) return fail(subject, "is empty", "give orbit:AZ,EL,DIST,FOV or a camera of the file");
  if (!word.starts_with(kOrbit)) return NamedCamera{std::string(word)};
  const std::string form =
      "write orbit:AZ,EL,DIST,FOV: degrees, elevation -90..90, distance in bounding-sphere radii above 0, "
      "vertical "
      "field of view between 0 and 180";
  const auto values = parseNumbers(word.substr(kOrbit.size()));
  if (!values || values->size() != 4) return fail(subject, "needs four numbers", form);
  const OrbitCamera orbit{(*values)[0], (*values)[1], (*values)[2], (*values)[3]};
  if (std::abs(orbit.elevation_deg) > 90.0f) return fail(subject, "has an elevation outside -90..90", form);
  if (orbit.distance_radii <= 0.0f || orbit.distance_radii > 1e4f)
    return fail(subject, "has a distance outside 0..10000", form);
  if (orbit.fov_deg < 0.01f || orbit.fov_deg > 179.0f)
    return fail(subject, "has a field of view outside 0..180", form);
  return orbit;
}

OrbitCamera framingOrbit(glm::vec3 bounds_min_ws, glm::vec3 bounds_max_ws, glm::vec3 open_side_ws,
                         float aspect) {
  constexpr float kFilled = 0.9f, kOpen = 0.25f;
  OrbitCamera orbit{.azimuth_deg = 25.0f, .elevation_deg = 12.0f, .distance_radii = 1.0f, .fov_deg = 35.0f};
  const glm::vec3 open(open_side_ws.x, 0.0f, open_side_ws.z), size = bounds_max_ws - bounds_min_ws;
  if (glm::length(open) > kOpen * size.y * std::max(size.x, size.z)) {
    constexpr float kAside = 8.0f;  // degrees; a view straight from the front would look flat
    orbit.azimuth_deg = glm::degrees(std::atan2(open.x, open.z)) + kAside;
    orbit.elevation_deg = 4.0f;
  }
  const glm::vec3 back = directionFromAzimuthElevation(orbit.azimuth_deg, orbit.elevation_deg);
  const glm::vec3 right = glm::normalize(glm::cross(glm::vec3(0.0f, 1.0f, 0.0f), back));
  const glm::vec3 up = glm::cross(back, right);
  const float half_height = kFilled * std::tan(glm::radians(0.5f * orbit.fov_deg));
  const glm::vec3 half = 0.5f * size;
  float distance = 0.0f;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 signs(corner & 1 ? 1.0f : -1.0f, corner & 2 ? 1.0f : -1.0f, corner & 4 ? 1.0f : -1.0f);
    const glm::vec3 place = signs * half;
    const float reach =
        std::max(std::abs(glm::dot(place, up)), std::abs(glm::dot(place, right)) / aspect) / half_height;
    distance = std::max(distance, glm::dot(place, back) + reach);
  }
  const float radius = 0.5f * glm::length(size);
  if (radius > 0.0f) orbit.distance_radii = std::max(distance / radius, 1.01f);
  return orbit;
}

View orbitView(const OrbitCamera& camera, glm::vec3 bounds_min_ws, glm::vec3 bounds_max_ws, float aspect) {
  const glm::vec3 centre = 0.5f * (bounds_min_ws + bounds_max_ws);
  const float radius = std::max(0.5f * glm::length(bounds_max_ws - bounds_min_ws), 1e-6f);
  const glm::vec3 to_eye = directionFromAzimuthElevation(camera.azimuth_deg, camera.elevation_deg);
  // Using the camera's own up axis avoids a special case for looking straight down (elevation 90).
  const glm::vec3 up = directionFromAzimuthElevation(camera.azimuth_deg, camera.elevation_deg + 90.0f);
  View view;
  view.eye_ws = centre + camera.distance_radii * radius * to_eye;
  view.view_from_world = glm::lookAt(view.eye_ws, centre, up);
  const DepthRange depth = fitDepth(view.view_from_world, bounds_min_ws, bounds_max_ws);
  view.clip_from_view = glm::perspective(glm::radians(camera.fov_deg), aspect, depth.near_m, depth.far_m);
  return view;
}

Result<std::uint32_t> findCameraNode(const std::vector<gltf::Node>& nodes,
                                     const std::vector<gltf::Camera>& cameras, const NamedCamera& wanted) {
  const std::string& word = wanted.name_or_index;
  const auto nodeWhere = [&](auto&& matches) -> std::int64_t {
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (nodes[i].camera >= 0 && static_cast<std::size_t>(nodes[i].camera) < cameras.size() &&
          matches(nodes[i]))
        return static_cast<std::int64_t>(i);
    return -1;
  };
  std::int64_t found = nodeWhere(
      [&](const gltf::Node& node) { return cameras[static_cast<std::size_t>(node.camera)].name == word; });
  if (found < 0) found = nodeWhere([&](const gltf::Node& node) { return node.name == word; });
  std::int32_t index = -1;
  const auto [stop, code] = std::from_chars(word.data(), word.data() + word.size(), index);
  if (found < 0 && code == std::errc{} && stop == word.data() + word.size())
    found = nodeWhere([&](const gltf::Node& node) { return node.camera == index; });
  if (found < 0) return fail("camera \"" + word + "\"", "no node of the file has it", known(cameras));
  return static_cast<std::uint32_t>(found);
}

Result<View> cameraView(const gltf::Camera& camera, const glm::mat4& world_from_node, glm::vec3 bounds_min_ws,
                        glm::vec3 bounds_max_ws, float aspect) {
  const std::string subject = "camera \"" + camera.name + "\"";
  const glm::vec3 back(world_from_node[2]), up(world_from_node[1]), eye(world_from_node[3]);
  const glm::vec3 right = glm::cross(up, back);
  const bool finite = std::isfinite(glm::dot(right, right) + glm::dot(back, back) + glm::dot(eye, eye));
  if (!finite || glm::length(right) <= 1e-6f * glm::length(up) * glm::length(back) ||
      glm::length(right) <= 0.0f)
    return fail(subject, "its node has no usable orientation", "give the node a rotation without zero scale");
  View view;
  view.eye_ws = eye;
  view.view_from_world = glm::lookAt(eye, eye - glm::normalize(back), up);
  const DepthRange depth = fitDepth(view.view_from_world, bounds_min_ws, bounds_max_ws);
  if (camera.perspective) {
    if (!(camera.yfov_rad > 0.0f && camera.yfov_rad < std::numbers::pi_v<float>))
      return fail(subject, "yfov is outside 0..pi", "set it to about 0.8");
    view.clip_from_view = glm::perspective(camera.yfov_rad, aspect, depth.near_m, depth.far_m);
  } else {
    if (!(camera.ymag > 0.0f) || !std::isfinite(camera.ymag))
      return fail(subject, "ymag is not above 0", "set it to half the height that is to be seen");
    const float half_width = camera.ymag * aspect;
    view.clip_from_view =
        glm::ortho(-half_width, half_width, -camera.ymag, camera.ymag, depth.near_m, depth.far_m);
  }
  return view;
}

}  // namespace lambent::spec
