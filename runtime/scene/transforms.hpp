// Updates world matrices and rigid groups from the Transforms, once per frame. Only entities with a changed
// version cost work. Parents are updated before their children in any order of entities, and hierarchies may
// have any depth.
#pragma once

#include <cstddef>

#include "runtime/ecs/registry.hpp"

namespace lambent::scene {

struct TransformUpdates {
  std::size_t nodes = 0;   // number of world matrices that were recomputed
  std::size_t groups = 0;  // number of rigid groups that moved
};

// Adds a WorldTransform for each Transform, and recomputes it if the Transform or the parent's matrix has a
// new version. Then updates the groups whose node's matrix has a new version. Results that do not change keep
// their version. A group that is flattened or mirrored since rest keeps its last rotation.
TransformUpdates updateTransforms(ecs::Registry& registry);

// Makes `parent` the parent of `child`; Entity{} stands for the world. The local transform stays, so the
// child moves in the world. Does nothing and returns false if the parent has no Transform, is the child or is
// below it.
bool setParent(ecs::Registry& registry, ecs::Entity child, ecs::Entity parent);

}  // namespace lambent::scene
