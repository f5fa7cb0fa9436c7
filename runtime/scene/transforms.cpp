#include "runtime/scene/transforms.hpp"

#include <cstdint>
#include <ranges>
#include <vector>

#include "runtime/scene/affine.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::scene {
namespace {

struct UpdateState {
  std::uint64_t seen = 0;   // version<Transform>() of the last update
  std::uint64_t visit = 0;  // number of this update
};

// Adds a WorldTransform for each Transform and removes all others.
void matchWorldTransforms(ecs::Registry& registry) {
  for (auto [entity, local] : registry.view<const Transform>()) {
    if (!registry.has<WorldTransform>(entity)) registry.emplace<WorldTransform>(entity);
  }
  if (registry.count<WorldTransform>() == registry.count<Transform>()) return;
  for (auto [entity, world] : registry.view<const WorldTransform>()) {
    if (!registry.has<Transform>(entity)) registry.remove<WorldTransform>(entity);
  }
}

// Returns true if the matrix was recomputed. The parent's matrix must be up to date.
bool updateNode(ecs::Registry& registry, ecs::Entity entity) {
  const Transform& local = registry.get<Transform>(entity);
  WorldTransform& world = registry.get<WorldTransform>(entity);
  const WorldTransform* parent = registry.tryGet<WorldTransform>(local.parent);
  const std::uint64_t local_version = registry.version<Transform>(entity);
  const std::uint64_t parent_version = registry.version<WorldTransform>(local.parent);
  if (world.seen_local == local_version && world.seen_parent == parent_version) return false;
  world.seen_local = local_version;
  world.seen_parent = parent_version;
  glm::mat4 world_from_node = localMatrix(local);
  if (parent) world_from_node = parent->world_from_node * world_from_node;
  if (world_from_node != world.world_from_node) {
    world.world_from_node = world_from_node;
    registry.touch<WorldTransform>(entity);
  }
  return true;
}

// Returns true if the group has moved.
bool updateGroup(const ecs::Registry& registry, RigidGroupComponent& group) {
  const WorldTransform* node = registry.tryGet<WorldTransform>(group.node);
  if (!node) return false;
  const std::uint64_t version = registry.version<WorldTransform>(group.node);
  if (version == group.seen_node) return false;
  group.seen_node = version;
  // This uses the motion since rest, not the node's matrix. Scale and mirrors that were there at rest cancel,
  // so the motion at rest is the identity.
  const glm::dmat4 motion = glm::dmat4(node->world_from_node) * group.node_from_world_at_rest;
  const glm::mat4 world_from_rest(motion);
  if (world_from_rest == group.world_from_rest) return false;
  group.world_from_rest = world_from_rest;
  group.translation = glm::vec3(motion * glm::dvec4(group.rest_translation, 1.0));
  if (const auto turn = polarRotation(glm::dmat3(motion))) {
    group.turn_since_rest = *turn;
    group.rotation = glm::normalize(*turn * group.rest_rotation);
  }
  return true;
}

}  // namespace

TransformUpdates updateTransforms(ecs::Registry& registry) {
  TransformUpdates updates;
  UpdateState& state = registry.state<UpdateState>();
  if (state.seen != registry.version<Transform>()) {
    state.seen = registry.version<Transform>();
    ++state.visit;
    matchWorldTransforms(registry);
    std::vector<ecs::Entity> chain;
    for (auto [start, local] : registry.view<const Transform>()) {
      // The loop climbs to the first ancestor that was visited, then comes back down.
      chain.clear();
      for (ecs::Entity at = start;;) {
        WorldTransform* world = registry.tryGet<WorldTransform>(at);
        if (!world || world->visit == state.visit) break;
        world->visit = state.visit;
        chain.push_back(at);
        at = registry.get<Transform>(at).parent;
      }
      for (const ecs::Entity entity : std::views::reverse(chain)) {
        if (updateNode(registry, entity)) ++updates.nodes;
      }
    }
  }
  for (auto [entity, group] : registry.view<RigidGroupComponent>()) {
    if (!updateGroup(registry, group)) continue;
    registry.touch<RigidGroupComponent>(entity);
    ++updates.groups;
  }
  return updates;
}

bool setParent(ecs::Registry& registry, ecs::Entity child, ecs::Entity parent) {
  if (parent && !registry.has<Transform>(parent)) return false;
  for (ecs::Entity at = parent; registry.has<Transform>(at); at = registry.get<Transform>(at).parent) {
    if (at == child) return false;
  }
  registry.edit<Transform>(child).parent = parent;
  return true;
}

}  // namespace lambent::scene
