// Converts the present Transforms of a bundle's nodes to edits of the scene that it is baked from. A node
// that was reparented stays in its place in the scene's own tree, because its StableId is made from that
// path, and the bake moves it to its place in the world. That it follows its new parent is known to the
// editor and the world file only.
#pragma once

#include "baker/import/scene_edits.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::editor {

void addNodeEdits(const ecs::Registry& registry, const bundle::Description& description,
                  const scene::SceneInstance& instance, baker::SceneEdits& edits);

}  // namespace lambent::editor
