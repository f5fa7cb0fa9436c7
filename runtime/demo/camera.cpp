#include "runtime/demo/camera.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "runtime/base/normal_matrix.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::demo {

namespace {

constexpr float kDegreesPerWindow = 220.0f;  // for a drag over the window's height
constexpr float kMaxElevationDeg = 89.0f;

std::optional<std::uint32_t> firstCameraNode(const bundle::Description& description) {
  for (std::uint32_t i = 0; i < description.nodes.size(); ++i)
    if (description.nodes[i].camera >= 0) return i;
  return {};
}

// An empty scene is framed like a unit box.
scene::Box boundsOf(const frame::World& world) {
  scene::Box bounds = scene::worldBounds(world.registry());
  if (bounds.empty()) {
    bounds.add(glm::vec3(-0.5f));
    bounds.add(glm::vec3(0.5f));
  }
  return bounds;
}

// Returns the side on which a scene is open, as a horizontal vector: the sum of area times normal over its
// surfaces. It is 0 for closed bodies and points out of a stage or a room without a front wall.
glm::vec3 openSide(const frame::World& world) {
  glm::vec3 sum(0.0f);
  for (auto [entity, draw] : world.registry().view<const scene::DrawItem>()) {
    const bundle::Description& description = world.description(draw.bundle);
    const bundle::Primitive& primitive = description.meshes[draw.mesh].primitives[draw.primitive];
    const float side = draw.back ? -1.0f : 1.0f;  // double-sided surfaces cancel
    const auto* place = world.registry().tryGet<scene::WorldTransform>(draw.node);
    if (!place) continue;
    sum +=
        side * glm::mat3(areaMatrix(glm::dmat3(glm::mat3(place->world_from_node)))) * primitive.vector_area;
  }
  return {sum.x, 0.0f, sum.z};
}

spec::OrbitCamera framingOrbit(const frame::World& world, float aspect) {
  const scene::Box bounds = boundsOf(world);
  return spec::framingOrbit(bounds.min, bounds.max, openSide(world), aspect);
}

glm::mat4 worldFromNode(const frame::World& world, std::size_t bundle, std::uint32_t node) {
  const auto* place = world.registry().tryGet<scene::WorldTransform>(world.instance(bundle).nodes[node]);
  return place ? place->world_from_node : glm::mat4(1.0f);
}

}  // namespace

Result<ViewController> ViewController::create(const frame::World& world,
                                              const std::optional<spec::Camera>& camera, float aspect) {
  ViewController controller;
  controller.bounds_ = boundsOf(world);
  controller.orbit_ = framingOrbit(world, aspect);
  if (camera && std::holds_alternative<spec::OrbitCamera>(*camera)) {
    controller.orbit_ = std::get<spec::OrbitCamera>(*camera);
  } else {
    std::optional<Error> error;
    for (std::uint32_t bundle = 0; bundle < world.bundleCount() && !controller.file_camera_; ++bundle) {
      if (!world.isOpen(bundle)) continue;
      const bundle::Description& description = world.description(bundle);
      if (!camera) {
        if (const auto node = firstCameraNode(description)) controller.file_camera_ = {bundle, *node};
        continue;
      }
      const Result<std::uint32_t> node =
          spec::findCameraNode(description.nodes, description.cameras, std::get<spec::NamedCamera>(*camera));
      if (node)
        controller.file_camera_ = {bundle, *node};
      else if (!error)
        error = node.error();
    }
    if (camera && !controller.file_camera_ && error) return failAgain(*error);
  }
  controller.first_file_camera_ = controller.file_camera_;
  controller.first_orbit_ = controller.orbit_;
  return controller;
}

Result<spec::View> ViewController::view(const frame::World& world, float aspect) const {
  if (!file_camera_) return spec::orbitView(orbit_, bounds_.min, bounds_.max, aspect);
  const bundle::Description& description = world.description(file_camera_->bundle);
  const auto camera = static_cast<std::size_t>(description.nodes[file_camera_->node].camera);
  return spec::cameraView(description.cameras[camera],
                          worldFromNode(world, file_camera_->bundle, file_camera_->node), bounds_.min,
                          bounds_.max, aspect);
}

void ViewController::move(const frame::World& world, const gpu::Input& input,
                          std::optional<float> surface_m) {
  if (input.reset) {
    file_camera_ = first_file_camera_;
    orbit_ = first_orbit_;
  }
  if (input.drag_x == 0.0f && input.drag_y == 0.0f && input.scroll == 0.0f) return;
  if (file_camera_) {
    const bundle::Description& description = world.description(file_camera_->bundle);
    const gltf::Camera& camera =
        description.cameras[static_cast<std::size_t>(description.nodes[file_camera_->node].camera)];
    const glm::vec3 offset =
        glm::vec3(worldFromNode(world, file_camera_->bundle, file_camera_->node)[3]) - bounds_.center();
    const float distance = std::max(glm::length(offset), 1e-6f);
    orbit_.azimuth_deg = glm::degrees(std::atan2(offset.x, offset.z));
    orbit_.elevation_deg = glm::degrees(std::asin(std::clamp(offset.y / distance, -1.0f, 1.0f)));
    orbit_.distance_radii = distance / std::max(bounds_.radius(), 1e-6f);
    if (camera.perspective) orbit_.fov_deg = glm::degrees(camera.yfov_rad);
    file_camera_.reset();
  }
  orbit_.azimuth_deg = std::remainder(orbit_.azimuth_deg - kDegreesPerWindow * input.drag_x, 360.0f);
  orbit_.elevation_deg = std::clamp(orbit_.elevation_deg + kDegreesPerWindow * input.drag_y,
                                    -kMaxElevationDeg, kMaxElevationDeg);
  const float radius = std::max(bounds_.radius(), 1e-6f);
  if (surface_m) *surface_m /= radius;
  orbit_.distance_radii = zoomed(orbit_.distance_radii, input.scroll, surface_m);
}

}  // namespace lambent::demo
