// What scripts and menus call things by: entities by name, id or search, scenes by id or number.
#pragma once

#include <string>
#include <vector>

#include "editor/document/snapshot.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

class Session;

// All that match; an error where none does. A whole name wins over parts of names.
Result<std::vector<ecs::Entity>> findEntities(const Session& session, const std::string& word);
// By id, number, or, where the word is empty, the scene at hand.
Result<std::size_t> findScene(const Session& session, const std::string& word);
// "point", "point 2", ...: a name that no entity has.
std::string freshName(const Session& session, const std::string& stem);

}  // namespace lambent::editor
