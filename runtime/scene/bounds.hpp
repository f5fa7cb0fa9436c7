// Computes axis-aligned bounding boxes of draws, groups and the whole scene, in world space and metres. A
// transformed box encloses the eight transformed corners. So a scene's bounds are those of its primitives'
// boxes at their nodes, as any reader of the glTF file gets them from min and max of the accessors. A volume
// has the box of its voxels. Orbit cameras use these bounds.
#pragma once

#include <limits>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/ecs/registry.hpp"

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

// Returns the box around the transformed corners. Empty boxes stay empty.
Box transformed(const Box& box, const glm::mat4& matrix);

// Returns whether the boxes have a point in common; empty boxes never do. The placements may be any affine
// transforms, because the test uses separating axes of parallelepipeds (Gottschalk, Lin and Manocha 1996). It
// is exact but for rounding.
bool meet(const Box& a, const glm::mat4& world_from_a, const Box& b, const glm::mat4& world_from_b);

// These functions read WorldTransform, so call updateTransforms first. A box is empty if the entity, or one
// that it refers to, does not exist any more.
Box drawBounds(const ecs::Registry& registry, ecs::Entity draw);
Box groupBounds(const ecs::Registry& registry, ecs::Entity group);
// Returns the box of all draws and volumes.
Box worldBounds(const ecs::Registry& registry);

}  // namespace lambent::scene
