// What duplicate and paste share: entities as snapshots, and made again under new ids. Inside this room.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "editor/document/history.hpp"

namespace lambent::editor {

// With all below them, parents first; only what a person could make. Errors: duplicate()'s.
Result<std::vector<EntitySnapshot>> copiesOf(const Document& document, std::span<const ecs::Entity> entities);

// One step; returns those whose parent is not among them.
Result<std::vector<ecs::Entity>> makeCopies(Document& document, History& history,
                                            std::vector<EntitySnapshot> copies, std::string name);

}  // namespace lambent::editor
