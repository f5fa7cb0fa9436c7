// Finds what scripts and menus mean by a word: entities by name, id or search, scenes by id or number.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "editor/document/snapshot.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

class Session;

// Returns all that match, or an error where none does. A whole name wins over parts of names.
Result<std::vector<ecs::Entity>> findEntities(const Session& session, const std::string& word);
// Returns the scene of the primary selected entity, else the only or first one; none is open: nothing.
std::optional<std::size_t> sceneAtHand(const Session& session);
// Finds a scene by its id or number, or the scene at hand where the word is empty.
Result<std::size_t> findScene(const Session& session, const std::string& word);
// Returns a name that no entity has: "point", "point 2", ...
std::string freshName(const Session& session, const std::string& stem);

}  // namespace lambent::editor
