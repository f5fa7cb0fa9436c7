#include "editor/session/camera_views.hpp"

#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "runtime/scene/affine.hpp"

namespace lambent::editor {

namespace {

// Returns the entity if it is a camera, or none.
ecs::Entity asCamera(const Session& session, ecs::Entity entity) {
  const ecs::Registry& registry = session.document.registry();
  const bool camera = registry.alive(entity) && registry.has<scene::CameraComponent>(entity) &&
                      registry.has<scene::Transform>(entity);
  return camera ? entity : ecs::Entity{};
}

}  // namespace

ecs::Entity selectedCamera(const Session& session) {
  return asCamera(session, session.selection.primaryEntity(session.document));
}

ecs::Entity shownCamera(const Session& session) {
  const ecs::Entity selected = session.preferences.camera_preview ? selectedCamera(session) : ecs::Entity{};
  return session.document.registry().alive(selected) ? selected
                                                     : asCamera(session, session.viewing.kept_camera);
}

float aspectOf(const Session& session, ecs::Entity camera) {
  const float own = session.document.registry().get<scene::CameraComponent>(camera).aspect;
  return own > 0.0f ? own : session.viewing.size.aspect();
}

Result<spec::View> viewOfCamera(const Session& session, ecs::Entity camera, float aspect) {
  const ecs::Registry& registry = session.document.registry();
  const auto& component = registry.get<scene::CameraComponent>(camera);
  gltf::Camera lens;
  lens.name = session.document.nameOf(camera);
  lens.perspective = component.perspective;
  lens.yfov_rad = component.yfov_rad;
  lens.xmag = component.xmag, lens.ymag = component.ymag;
  const glm::mat4 world_from_node = worldFromNode(registry, camera);
  scene::Box box = scene::worldBounds(registry);
  if (box.empty()) box.add(glm::vec3(world_from_node[3]));
  return spec::cameraView(lens, world_from_node, box.min, box.max, aspect);
}

void lookThrough(Session& session, ecs::Entity camera) {
  const ecs::Registry& registry = session.document.registry();
  session.viewing.goal = fromNode(worldFromNode(registry, camera),
                                  registry.get<scene::CameraComponent>(camera), scene::worldBounds(registry));
  session.viewing.changed = true;
}

Result<void> placeAtView(Session& session, ecs::Entity camera) {
  const ecs::Registry& registry = session.document.registry();
  const CameraPose& pose = session.viewing.goal;
  const ecs::Entity parent = parentOf(registry, camera);
  const glm::mat4 world_from_parent =
      registry.alive(parent) ? worldFromNode(registry, parent) : glm::mat4(1.0f);
  scene::Transform to = registry.get<scene::Transform>(camera);
  scene::setLocalMatrix(to, glm::inverse(world_from_parent) * nodeMatrix(pose));
  const FieldEdit edits[] = {
      {camera, "Transform", "translation", to.translation},
      {camera, "Transform", "rotation", to.rotation},
      {camera, "Transform", "scale", to.scale},
      {camera, "Transform", "shear", to.shear},
      {camera, "Camera", "perspective", !pose.orthographic},
      {camera, "Camera", "yfov", glm::radians(pose.fov_deg)},
      {camera, "Camera", "ymag", pose.halfHeight()},
      {camera, "Camera", "xmag", pose.halfHeight() * session.viewing.size.aspect()},
  };
  return session.history.setFields(edits, "place of " + session.document.nameOf(camera));
}

}  // namespace lambent::editor
