// Finds which parts of a scene move together. The rigid group is the unit of transport: nodes that never move
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

// PlannedDraw is one side of a primitive at a node; double-sided materials give two.
struct PlannedDraw {
  std::uint32_t node = 0, mesh = 0, primitive = 0;
  bool back = false;
  glm::mat4 group_from_mesh{1.0f};
};

struct RigidGroup {
  std::string name;
  std::int32_t root = -1;  // node; -1 for the static group
  // These give world_from_group at rest: the root's position and the rotation of its world matrix (polar
  // factor), without scale.
  glm::vec3 rest_translation{0.0f};
  glm::quat rest_rotation{1.0f, 0.0f, 0.0f, 0.0f};
  std::vector<PlannedDraw> draws;
  // This is an index into Scene::volumes, or -1 for a group of surfaces. A volume is a group by itself, whose
  // root is its node.
  std::int32_t volume = -1;
  // For a volume, this is the index, in the same list, of the group of surfaces that it never moves against;
  // -1 if none.
  std::int32_t within = -1;
};

// Returns whether the node, with all below it, moves by itself.
inline bool startsRigidGroup(const gltf::Node& node) {
  return node.animated || node.movable;
}

// Returns the transform of a node of the group in the group's frame. `world` holds worldTransforms of the
// scene's nodes. The result is built from the nodes below the root, so it stays the same to the last bit
// while the group moves as a whole.
glm::mat4 groupFromNode(const Scene& scene, const RigidGroup& group, std::uint32_t node,
                        const std::vector<glm::mat4>& world);

// Leaves out groups without geometry. Draws come in the order of the scene graph; volumes come last, in the
// order of Scene::volumes.
std::vector<RigidGroup> findRigidGroups(const Scene& scene);

}  // namespace lambent::baker
