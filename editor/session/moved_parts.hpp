// Finds nodes that moved within their rigid group since the bake. The group's transfer still has them in the
// old place.
#pragma once

#include <string>
#include <vector>

#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::editor {

// Adds a sentence for each node that has moved relative to its group. A group that moved as a whole needs
// none.
void addMovedParts(const ecs::Registry& registry, const bundle::Description& description,
                   const scene::SceneInstance& instance, std::vector<std::string>& sentences);

}  // namespace lambent::editor
