#include "runtime/scene/transforms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <vector>

#include <glm/geometric.hpp>

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

// Recomputes the matrix if it is out of date. The parent's must be up to date.
void updateNode(ecs::Registry& registry, ecs::Entity entity) {
  const Transform& local = registry.get<Transform>(entity);
  WorldTransform& world = registry.get<WorldTransform>(entity);
  const WorldTransform* parent = registry.tryGet<WorldTransform>(local.parent);
  const std::uint64_t local_version = registry.version<Transform>(entity);
  const std::uint64_t parent_version = registry.version<WorldTransform>(local.parent);
  if (world.seen_local == local_version && world.seen_parent == parent_version) return;
  world.seen_local = local_version;
  world.seen_parent = parent_version;
  glm::mat4 world_from_node = localMatrix(local);
  if (parent) world_from_node = parent->world_from_node * world_from_node;
  if (world_from_node != world.world_from_node) {
    world.world_from_node = world_from_node;
    registry.touch<WorldTransform>(entity);
  }
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

void updateTransforms(ecs::Registry& registry) {
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
      for (const ecs::Entity entity : std::views::reverse(chain)) updateNode(registry, entity);
    }
  }
  for (auto [entity, group] : registry.view<RigidGroupComponent>()) {
    if (updateGroup(registry, group)) registry.touch<RigidGroupComponent>(entity);
  }
}

glm::mat4 localMatrix(const Transform& t) {
  const glm::mat3 rotation = glm::mat3_cast(t.rotation);
  const glm::vec3 x = rotation[0] * t.scale.x, y = rotation[1] * t.scale.y, z = rotation[2] * t.scale.z;
  return glm::mat4(glm::vec4(x, 0.0f), glm::vec4(x * t.shear.x + y, 0.0f),
                   glm::vec4(x * t.shear.y + y * t.shear.z + z, 0.0f), glm::vec4(t.translation, 1.0f));
}

void setLocalMatrix(Transform& transform, const glm::mat4& parent_from_node) {
  // Gram-Schmidt orthogonalisation gives columns = axes * scale * shear. A column that depends linearly on
  // those before it has scale 0. Its axis is chosen last, orthogonal to all others, where no later column has
  // a component.
  const glm::dmat3 columns{glm::mat3(parent_from_node)};
  std::array<glm::dvec3, 3> axes{};
  std::array<bool, 3> found{};
  glm::dvec3 scale{0.0};
  glm::dmat3 part{0.0};  // part[j][i] is the component of column j along axis i
  for (int j = 0; j < 3; ++j) {
    glm::dvec3 rest = columns[j];
    for (int i = 0; i < j; ++i) {
      if (!found[static_cast<std::size_t>(i)]) continue;
      part[j][i] = glm::dot(rest, axes[static_cast<std::size_t>(i)]);
      rest -= part[j][i] * axes[static_cast<std::size_t>(i)];
    }
    // Cancellation of float columns leaves noise of about 1e-7 of their length.
    const double length = glm::length(rest);
    if (length == 0.0 || length <= 1e-6 * glm::length(columns[j])) continue;
    found[static_cast<std::size_t>(j)] = true;
    axes[static_cast<std::size_t>(j)] = rest / length;
    scale[j] = length;
  }
  for (std::size_t j = 0; j < 3; ++j) {
    if (found[j]) continue;
    double longest = 0.0;  // of what the axes found leave of +X, +Y and +Z
    for (int i = 0; i < 3; ++i) {
      glm::dvec3 rest(0.0);
      rest[i] = 1.0;
      for (std::size_t k = 0; k < 3; ++k)
        if (found[k]) rest -= glm::dot(rest, axes[k]) * axes[k];
      if (const double length = glm::length(rest); length > longest) {
        longest = length;
        axes[j] = rest / length;
      }
    }
    found[j] = true;
  }
  glm::dmat3 rotation(axes[0], axes[1], axes[2]);
  if (glm::determinant(rotation) < 0.0) {
    rotation[0] = -rotation[0];
    scale.x = -scale.x;
    part[1][0] = -part[1][0];
    part[2][0] = -part[2][0];
  }
  const auto ratio = [](double along, double by) { return by == 0.0 ? 0.0 : along / by; };
  transform.translation = glm::vec3(parent_from_node[3]);
  transform.rotation = glm::quat(glm::normalize(glm::quat_cast(rotation)));
  transform.scale = glm::vec3(scale);
  transform.shear = glm::vec3(
      glm::dvec3(ratio(part[1][0], scale.x), ratio(part[2][0], scale.x), ratio(part[2][1], scale.y)));
}

float largestScale(const glm::mat4& matrix) {
  float scale = 0.0f;
  for (int column = 0; column < 3; ++column) scale = std::max(scale, glm::length(glm::vec3(matrix[column])));
  return scale;
}

std::optional<glm::quat> polarRotation(const glm::dmat3& linear) {
  glm::dmat3 q = linear;
  double size = 0.0;
  for (int j = 0; j < 3; ++j) size += glm::dot(q[j], q[j]);
  const double cubed = std::pow(size, 1.5);
  // The determinant is compared with the size of the matrix, so that small models do not count as flat. NaN
  // fails the comparison, too.
  if (!(glm::determinant(q) > 1e-12 * cubed)) return std::nullopt;
  q /= std::cbrt(glm::determinant(q));
  // Convergence is quadratic near the end. Far from it each step halves the largest scale, so 100 steps
  // suffice.
  for (int step = 0; step < 100; ++step) {
    const glm::dmat3 next = 0.5 * (q + glm::transpose(glm::inverse(q)));
    double change = 0.0;
    for (int j = 0; j < 3; ++j) change += glm::dot(next[j] - q[j], next[j] - q[j]);
    q = next;
    if (change < 1e-24) break;
  }
  return glm::quat(glm::normalize(glm::quat_cast(q)));
}

}  // namespace lambent::scene
