// Keeps world matrices and the place of rigid groups in step with the Transforms, once a frame. Work is done
// only where a version has changed; parents come before children whatever their order, and hierarchies may be
// of any depth.
#pragma once

#include <cstddef>

#include "runtime/ecs/registry.hpp"

namespace lambent::scene {

struct TransformUpdates {
  std::size_t nodes = 0;   // world matrices computed again
  std::size_t groups = 0;  // rigid groups that moved
};

// Makes a WorldTransform for each Transform, computes it where the Transform or its parent's matrix has a new
// version, then moves the groups whose node's matrix has one. What comes out the same keeps its version. A
// group that is flattened or mirrored since rest has no rotation: it keeps the last one.
TransformUpdates updateTransforms(ecs::Registry& registry);

// Hangs `child` below `parent` (none: the world); its local transform stays, so it moves along. False, and
// nothing changes, if the parent has no Transform or is the child or below it.
bool setParent(ecs::Registry& registry, ecs::Entity child, ecs::Entity parent);

}  // namespace lambent::scene
