// Which parts of a scene move together. The rigid group is the unit of transport: nodes that never move
// relative to each other shadow and light each other in the bake. An animated node, or one with
// extras.lambent.movable, starts a group of its own with all its descendants; everything else is one static
// group.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"

namespace lambent::baker {

// One side of a primitive at a node. Double-sided materials give two.
struct PlannedDraw {
  std::uint32_t node = 0, mesh = 0, primitive = 0;
  bool back = false;
  glm::mat4 group_from_mesh{1.0f};
};

struct RigidGroup {
  std::string name;
  std::int32_t root = -1;  // node; -1: the static group
  // world_from_group at rest: the root's place and the rotation of its world matrix (polar factor), without
  // scale.
  glm::vec3 rest_translation{0.0f};
  glm::quat rest_rotation{1.0f, 0.0f, 0.0f, 0.0f};
  std::vector<PlannedDraw> draws;
  // A volume is a group by itself, whose root is its node: into Scene::volumes; -1: surfaces.
  std::int32_t volume = -1;
  // Of a volume: the group of surfaces that it never moves against, into the same list; -1: none.
  std::int32_t within = -1;
};

// Whether the node, with all below it, moves by itself.
inline bool startsRigidGroup(const gltf::Node& node) {
  return node.animated || node.movable;
}

// Where a node of a group stands in the group's frame. world: worldTransforms of the scene's nodes. Built
// from the nodes below the root, so that it stays the same to the last bit while the group moves as a whole.
glm::mat4 groupFromNode(const Scene& scene, const RigidGroup& group, std::uint32_t node,
                        const std::vector<glm::mat4>& world);

// Groups without geometry are left out. Draws come in the order of the scene graph; volumes come last, in the
// order of Scene::volumes.
std::vector<RigidGroup> findRigidGroups(const Scene& scene);

}  // namespace lambent::baker
