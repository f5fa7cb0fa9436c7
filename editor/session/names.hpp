// Resolves words of scripts and menus: entities by name, id or search, scenes by id or number. Lists are
// filtered by words, in any order and case.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "editor/document/document.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

class Session;

// Returns whether all words of the search are parts of the text.
bool holdsWords(std::string_view text, std::string_view search);
// Returns all matches, or an error if there is none. A match of the whole name wins over matches of parts.
Result<std::vector<ecs::Entity>> findEntities(const Session& session, const std::string& word);
// Returns the scene of the primary selected entity, else the first scene, or none if no scene is open.
std::optional<std::size_t> sceneAtHand(const Session& session);
// Finds a scene by its id or number. An empty word means sceneAtHand().
Result<std::size_t> findScene(const Session& session, const std::string& word);

}  // namespace lambent::editor
