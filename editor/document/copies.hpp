// Snapshots entities and creates them again under new ids, for duplicate and paste. Only this room uses it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "editor/document/history.hpp"

namespace lambent::editor {

// Returns snapshots of the entities and their descendants, parents first. Errors: those of duplicate().
Result<std::vector<EntitySnapshot>> copiesOf(const Document& document, std::span<const ecs::Entity> entities);

// Creates entities from the snapshots as one step of the history. Returns those whose parent is not among
// them.
Result<std::vector<ecs::Entity>> makeCopies(Document& document, History& history,
                                            std::vector<EntitySnapshot> copies, std::string name);

}  // namespace lambent::editor
