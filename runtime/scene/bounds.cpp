#include "runtime/scene/bounds.hpp"

#include <array>
#include <cmath>

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

namespace {

struct Placed {
  glm::dvec3 center;
  std::array<glm::dvec3, 3> halves;  // of the edges
};

Placed place(const Box& box, const glm::mat4& world_from_box, const glm::dvec3& origin) {
  const glm::dmat4 matrix(world_from_box);
  const glm::dvec3 low(box.min), high(box.max), half = 0.5 * (high - low);
  return {glm::dvec3(matrix * glm::dvec4(0.5 * (low + high), 1.0)) - origin,
          {half.x * glm::dvec3(matrix[0]), half.y * glm::dvec3(matrix[1]), half.z * glm::dvec3(matrix[2])}};
}

// Returns whether the axis separates the boxes. Boxes that touch are not separated.
bool apart(const Placed& a, const Placed& b, const glm::dvec3& axis) {
  double reach = 0.0;
  for (const Placed* box : {&a, &b})
    for (const glm::dvec3& half : box->halves) reach += std::abs(glm::dot(axis, half));
  return std::abs(glm::dot(axis, b.center - a.center)) > reach;
}

}  // namespace

bool meet(const Box& a, const glm::mat4& world_from_a, const Box& b, const glm::mat4& world_from_b) {
  if (a.empty() || b.empty()) return false;
  const glm::dvec3 origin(world_from_a[3]);
  const Placed at_a = place(a, world_from_a, origin), at_b = place(b, world_from_b, origin);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (apart(at_a, at_b, glm::cross(at_a.halves[i], at_a.halves[j]))) return false;
    if (apart(at_a, at_b, glm::cross(at_b.halves[i], at_b.halves[j]))) return false;
    for (const glm::dvec3& half : at_b.halves)
      if (apart(at_a, at_b, glm::cross(at_a.halves[i], half))) return false;
  }
  return true;
}

}  // namespace lambent::scene
