// Takes entities as snapshots and makes them again under new ids, for duplicate and paste. Only this room
// uses it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "editor/document/history.hpp"

namespace lambent::editor {

// Returns snapshots of the entities and all below them, parents first. Errors: those of duplicate().
Result<std::vector<EntitySnapshot>> copiesOf(const Document& document, std::span<const ecs::Entity> entities);

// Makes them as one step of the history, and returns those whose parent is not among them.
Result<std::vector<ecs::Entity>> makeCopies(Document& document, History& history,
                                            std::vector<EntitySnapshot> copies, std::string name);

}  // namespace lambent::editor
