#include "editor/document/field_use.hpp"

#include <glm/geometric.hpp>

#include "runtime/scene/components.hpp"

namespace lambent::editor {

namespace {

bool isUsed(const scene::LocalLightComponent& light, std::string_view field) {
  using Kind = scene::LocalLightComponent::Kind;
  if (field == "radius") return light.kind == Kind::Sphere || light.kind == Kind::Disc;
  if (field == "range") return light.kind == Kind::Point || light.kind == Kind::Spot;
  if (field == "inner_cone" || field == "outer_cone") return light.kind == Kind::Spot;
  return true;
}

bool isUsed(const scene::CameraComponent& camera, std::string_view field) {
  if (field == "yfov" || field == "aspect") return camera.perspective;
  if (field == "xmag" || field == "ymag") return !camera.perspective;
  return true;
}

}  // namespace

bool isUsed(const ecs::Registry& registry, ecs::Entity entity, const scene::FieldInfo& field) {
  if (field.component == scene::LocalLightComponent::kComponentName)
    return isUsed(registry.get<scene::LocalLightComponent>(entity), field.name);
  if (field.component == scene::CameraComponent::kComponentName)
    return isUsed(registry.get<scene::CameraComponent>(entity), field.name);
  // Only matrices of files have shear; taken apart, others have a rounding error.
  if (field.component == scene::Transform::kComponentName && field.name == "shear")
    return glm::length(registry.get<scene::Transform>(entity).shear) > 1e-6f;
  if (field.component == scene::MaterialComponent::kComponentName && field.name == "anisotropy_rotation")
    return registry.get<scene::MaterialComponent>(entity).anisotropy > 0.0f;
  return true;
}

}  // namespace lambent::editor
