#include "runtime/scene/bounds.hpp"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "runtime/ecs/registry.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::scene {
namespace {

Box boundsOf(const ecs::Registry& registry, const DrawItem& item) {
  const auto* node = registry.tryGet<WorldTransform>(item.node);
  return node ? transformed(item.bounds, node->world_from_node) : Box{};
}

glm::mat4 worldFromGroup(const RigidGroupComponent& group) {
  return group.world_from_rest * glm::translate(glm::mat4(1.0f), group.rest_translation) *
         glm::mat4_cast(group.rest_rotation);
}

}  // namespace

float Box::radius() const {
  return empty() ? 0.0f : 0.5f * glm::length(max - min);
}

void Box::add(glm::vec3 point) {
  min = glm::min(min, point);
  max = glm::max(max, point);
}

void Box::add(const Box& other) {
  min = glm::min(min, other.min);
  max = glm::max(max, other.max);
}

Box transformed(const Box& box, const glm::mat4& matrix) {
  Box result;
  if (box.empty()) return result;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 point((corner & 1) != 0 ? box.max.x : box.min.x,
                          (corner & 2) != 0 ? box.max.y : box.min.y,
                          (corner & 4) != 0 ? box.max.z : box.min.z);
    result.add(glm::vec3(matrix * glm::vec4(point, 1.0f)));
  }
  return result;
}

Box drawBounds(const ecs::Registry& registry, ecs::Entity draw) {
  const auto* item = registry.tryGet<DrawItem>(draw);
  return item ? boundsOf(registry, *item) : Box{};
}

Box groupBounds(const ecs::Registry& registry, ecs::Entity entity) {
  const auto* group = registry.tryGet<RigidGroupComponent>(entity);
  if (!group) return {};
  return transformed(group->bounds, worldFromGroup(*group));
}

Box worldBounds(const ecs::Registry& registry) {
  Box all;
  for (auto [entity, item] : registry.view<DrawItem>()) all.add(boundsOf(registry, item));
  for (auto [entity, group, volume] : registry.view<RigidGroupComponent, VolumeItem>())
    all.add(transformed({glm::vec3(0.0f), glm::vec3(volume.size)},
                        worldFromGroup(group) * volume.group_from_grid));
  return all;
}

}  // namespace lambent::scene
