// Replaces a bundle in a registry by another one, which is the same scene baked better, or changed and baked
// again. Entities are matched by their StableIds. An entity of both bundles is kept, with all changes that
// the user made: declared fields that differ from the old bundle, components added or removed, another
// parent, destruction. All its other values come from the new bundle. Entities of the old bundle only are
// destroyed, and those of the new bundle only are created. playAnimations gives animated nodes a new pose
// from the new keys.
#pragma once

#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::scene {

// Replaces `instance`, which was made from `before` with these options. World matrices and groups are up to
// date on return.
SceneInstance exchangeInstance(ecs::Registry& registry, const SceneInstance& instance,
                               const bundle::Description& before, const bundle::Description& now,
                               const InstantiateOptions& options);

}  // namespace lambent::scene
