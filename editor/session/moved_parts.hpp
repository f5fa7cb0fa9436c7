// Finds what moved within a rigid group since it was baked: the group's transfer still has it in its old
// place.
#pragma once

#include <string>
#include <vector>

#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::editor {

// Adds a sentence for each node that no longer stands where its group has it. Groups that moved as a whole
// are right.
void addMovedParts(const ecs::Registry& registry, const bundle::Description& description,
                   const scene::SceneInstance& instance, std::vector<std::string>& sentences);

}  // namespace lambent::editor
