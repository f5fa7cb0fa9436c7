// Writes where the nodes of a bundle stand now as edits of the scene that it is baked from. A node that was
// hung elsewhere stays in the scene's own tree, whose paths its StableId is made from, and keeps its place in
// the world: a bake moves it there. That it follows its new parent is the editor's and the world file's.
#pragma once

#include "baker/import/scene_edits.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::editor {

void addNodeEdits(const ecs::Registry& registry, const bundle::Description& description,
                  const scene::SceneInstance& instance, baker::SceneEdits& edits);

}  // namespace lambent::editor
