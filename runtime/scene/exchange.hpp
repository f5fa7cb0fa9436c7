// Another bundle in the place of one that stands in a registry: the same scene baked better, or changed and
// baked again. Entities are told by their StableIds: one that is in both stays the same entity, with what was
// changed by hand (every declared field that is not what the old bundle says, components taken off or put on,
// a parent set anew, an entity destroyed) and with all else as the new bundle has it. What the old bundle
// alone has goes, what the new one alone has comes. Nodes that an animation has moved are posed anew by
// playAnimations, from the new bundle's keys.
#pragma once

#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::scene {

// `instance` was made from `before` with these options. World matrices and groups are up to date on return.
SceneInstance exchangeInstance(ecs::Registry& registry, const SceneInstance& instance,
                               const bundle::Description& before, const bundle::Description& now,
                               const InstantiateOptions& options);

}  // namespace lambent::scene
