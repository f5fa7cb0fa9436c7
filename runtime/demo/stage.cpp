#include "runtime/demo/stage.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>

#include "runtime/base/normal_matrix.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::demo {

namespace {

constexpr float kDegreesPerWindow = 220.0f;  // for a drag over the window's height
constexpr float kMaxElevationDeg = 89.0f;

std::optional<std::uint32_t> firstCameraNode(const bundle::Description& description) {
  for (std::uint32_t i = 0; i < description.nodes.size(); ++i)
    if (description.nodes[i].camera >= 0) return i;
  return {};
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

}  // namespace

Result<lighting::Environment> loadEnvironment(const Options& options) {
  Result<lighting::Environment> environment =
      lighting::Environment::create(options.lights, options.fade_lights);
  if (!environment) return failAgain(environment.error());
  environment->setMostKeys(options.settings.mostKeys());
  environment->setKeyEdits(options.key_edits);
  for (const spec::KeyEdit& edit : options.key_edits)
    if (std::ranges::none_of(environment->foundKeys(),
                             [&](const lighting::Environment::FoundKey& key) { return key.edit == edit; }))
      fmt::print(stderr, "lambent-demo: {}: no key light was found there\n", spec::keyEditWord(edit));
  for (const std::string& notice : environment->notices()) fmt::print(stderr, "lambent-demo: {}\n", notice);
  return environment;
}

Stage::Stage(const Options& options, lighting::Environment environment)
    : world_({.max_resident_bytes = options.max_memory_bytes}), environment_(std::move(environment)) {}

Result<Stage> Stage::create(const Options& options, lighting::Environment environment) {
  Stage stage(options, std::move(environment));
  for (const std::filesystem::path& path : options.bundles)
    if (const auto opened = stage.world_.open(path); !opened) return failAgain(opened.error());
  stage.world_.scaleLamps(options.lamps);
  scene::addLights(stage.world_.registry(), options.lights, stage.world_.origin());
  stage.environment_.setTurn(options.rotate_light_deg);
  stage.environment_.setFade(options.fade);
  if (const Result<void> chosen = stage.chooseView(options.camera, options.size.aspect()); !chosen)
    return failAgain(chosen.error());
  return stage;
}

Result<void> Stage::chooseView(const std::optional<spec::Camera>& camera, float aspect) {
  bounds_ = scene::worldBounds(world_.registry());
  if (bounds_.empty()) {  // an empty scene is framed like a unit box
    bounds_.add(glm::vec3(-0.5f));
    bounds_.add(glm::vec3(0.5f));
  }
  orbit_ = spec::framingOrbit(bounds_.min, bounds_.max, openSide(world_), aspect);
  if (camera && std::holds_alternative<spec::OrbitCamera>(*camera)) {
    orbit_ = std::get<spec::OrbitCamera>(*camera);
  } else {
    std::optional<Error> error;
    for (std::uint32_t bundle = 0; bundle < world_.bundleCount() && !file_camera_; ++bundle) {
      if (!world_.isOpen(bundle)) continue;
      const bundle::Description& description = world_.description(bundle);
      if (!camera) {
        if (const auto node = firstCameraNode(description)) file_camera_ = {bundle, *node};
        continue;
      }
      const Result<std::uint32_t> node =
          spec::findCameraNode(description.nodes, description.cameras, std::get<spec::NamedCamera>(*camera));
      if (node)
        file_camera_ = {bundle, *node};
      else if (!error)
        error = node.error();
    }
    if (camera && !file_camera_ && error) return failAgain(*error);
  }
  first_file_camera_ = file_camera_;
  first_orbit_ = orbit_;
  return {};
}

const gltf::Camera& Stage::fileCamera() const {
  const bundle::Description& description = world_.description(file_camera_->bundle);
  return description.cameras[static_cast<std::size_t>(description.nodes[file_camera_->node].camera)];
}

glm::mat4 Stage::worldFromCamera() const {
  const ecs::Entity node = world_.instance(file_camera_->bundle).nodes[file_camera_->node];
  const auto* place = world_.registry().tryGet<scene::WorldTransform>(node);
  return place ? place->world_from_node : glm::mat4(1.0f);
}

Result<spec::View> Stage::view(float aspect) const {
  if (!file_camera_) return spec::orbitView(orbit_, bounds_.min, bounds_.max, aspect);
  return spec::cameraView(fileCamera(), worldFromCamera(), bounds_.min, bounds_.max, aspect);
}

void Stage::move(const gpu::Input& input, std::optional<float> surface_m) {
  if (input.reset) {
    file_camera_ = first_file_camera_;
    orbit_ = first_orbit_;
  }
  if (input.drag_x == 0.0f && input.drag_y == 0.0f && input.scroll == 0.0f) return;
  const float radius = std::max(bounds_.radius(), 1e-6f);
  if (file_camera_) {
    const glm::vec3 offset = glm::vec3(worldFromCamera()[3]) - bounds_.center();
    const float distance = std::max(glm::length(offset), 1e-6f);
    orbit_.azimuth_deg = glm::degrees(std::atan2(offset.x, offset.z));
    orbit_.elevation_deg = glm::degrees(std::asin(std::clamp(offset.y / distance, -1.0f, 1.0f)));
    orbit_.distance_radii = distance / radius;
    if (fileCamera().perspective) orbit_.fov_deg = glm::degrees(fileCamera().yfov_rad);
    file_camera_.reset();
  }
  orbit_.azimuth_deg = std::remainder(orbit_.azimuth_deg - kDegreesPerWindow * input.drag_x, 360.0f);
  orbit_.elevation_deg = std::clamp(orbit_.elevation_deg + kDegreesPerWindow * input.drag_y,
                                    -kMaxElevationDeg, kMaxElevationDeg);
  if (surface_m) *surface_m /= radius;
  orbit_.distance_radii = zoomed(orbit_.distance_radii, input.scroll, surface_m);
}

void Stage::dragLight(const spec::View& view, float right, float down) {
  ecs::Registry& registry = world_.registry();
  for (auto [entity, light] : registry.view<const scene::LocalLightComponent>()) {
    const auto* place = registry.tryGet<scene::WorldTransform>(entity);
    if (light.kind == scene::LocalLightComponent::Kind::Directional || !place) continue;
    const glm::vec3 position_vs(view.view_from_world * place->world_from_node[3]);
    // This is the picture's height at the light's distance; an orthographic picture is equally high
    // everywhere.
    const bool perspective = view.clip_from_view[2][3] != 0.0f;
    const float height = 2.0f / view.clip_from_view[1][1] * (perspective ? std::abs(position_vs.z) : 1.0f);
    const glm::vec3 by_vs = height * glm::vec3(right, -down, 0.0f);
    const glm::vec3 by_ws = glm::transpose(glm::mat3(view.view_from_world)) * by_vs;
    const auto& transform = registry.get<scene::Transform>(entity);
    const auto* parent = registry.tryGet<scene::WorldTransform>(transform.parent);
    const glm::mat3 parent_from_world =
        parent ? glm::inverse(glm::mat3(parent->world_from_node)) : glm::mat3(1.0f);
    const glm::vec3 by_parent = parent_from_world * by_ws;
    if (!glm::all(glm::equal(by_parent, by_parent))) return;  // its parent is scaled flat
    registry.edit<scene::Transform>(entity).translation += by_parent;
    return;
  }
}

}  // namespace lambent::demo
