// Axis-aligned boxes, and those of what a registry shows in world space, metres. A box under a matrix is the
// box around its eight corners moved, so a scene's bounds are those of its primitives' boxes at their nodes:
// what any reader of the glTF file gets from its accessors' min and max; a volume's box is that of its
// voxels. Orbit cameras stand by these bounds.
#pragma once

#include <limits>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/ecs/entity.hpp"

namespace lambent::ecs {
class Registry;
}

namespace lambent::scene {

struct Box {
  glm::vec3 min{std::numeric_limits<float>::infinity()};
  glm::vec3 max{-std::numeric_limits<float>::infinity()};

  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  glm::vec3 center() const { return 0.5f * (min + max); }
  float radius() const;  // half the diagonal; 0 if empty
  void add(glm::vec3 point);
  void add(const Box& other);
};

// Empty boxes stay empty.
Box transformed(const Box& box, const glm::mat4& matrix);

// These read WorldTransform: call updateTransforms first. Empty where an entity or what it refers to is gone.
Box drawBounds(const ecs::Registry& registry, ecs::Entity draw);
Box groupBounds(const ecs::Registry& registry, ecs::Entity group);
// Of all draws and volumes.
Box worldBounds(const ecs::Registry& registry);

}  // namespace lambent::scene
