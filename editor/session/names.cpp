#include "editor/session/names.hpp"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "editor/session/session.hpp"
#include "runtime/base/lower_case.hpp"

namespace lambent::editor {

bool holdsWords(std::string_view text, std::string_view search) {
  const std::string low = lowerCase(text);
  std::istringstream words(lowerCase(search));
  for (std::string word; words >> word;)
    if (low.find(word) == std::string::npos) return false;
  return true;
}

Result<std::vector<ecs::Entity>> findEntities(const Session& session, const std::string& word) {
  TreeQuery query;
  query.filter =
      word.find(':') == std::string::npos && word.find(' ') != std::string::npos ? "\"" + word + "\"" : word;
  std::vector<ecs::Entity> whole, part;
  for (const TreeRow& row : treeRows(session.document, query)) {
    if (!row.matches) continue;
    part.push_back(row.entity);
    if (row.name == word) whole.push_back(row.entity);
  }
  if (!whole.empty()) return whole;
  if (!part.empty()) return part;
  return fail(word, "nothing of that name is there", "\"tree\" lists all there is");
}

std::optional<std::size_t> sceneAtHand(const Session& session) {
  const auto& entries = session.scenes.entries();
  if (entries.empty()) return std::nullopt;
  const ecs::Entity primary = session.selection.primaryEntity(session.document);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!entries[i].slot) continue;
    const scene::SceneInstance& instance = session.stage.world().instance(*entries[i].slot);
    if (primary == instance.root || isBelow(session.document.registry(), primary, instance.root)) return i;
    const auto holds = [&](const std::vector<ecs::Entity>& list) {
      return std::find(list.begin(), list.end(), primary) != list.end();
    };
    if (holds(instance.groups) || holds(instance.draws) || holds(instance.animations)) return i;
  }
  return 0;
}

Result<std::size_t> findScene(const Session& session, const std::string& word) {
  const auto& entries = session.scenes.entries();
  if (word.empty()) {
    if (const auto entry = sceneAtHand(session)) return *entry;
    return fail("scene", "none is open", "open one first");
  }
  std::vector<std::string> known;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].id == word || std::to_string(i) == word) return i;
    known.push_back(entries[i].id);
  }
  return fail(word, "is no open scene", fmt::format("open are: {}", fmt::join(known, ", ")));
}

}  // namespace lambent::editor
