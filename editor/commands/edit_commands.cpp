#include <array>

#include "editor/commands/rows.hpp"
#include "editor/document/actions.hpp"

namespace lambent::editor {

namespace {

bool canUndo(const Session& session) {
  return session.history.canUndo();
}
bool canRedo(const Session& session) {
  return session.history.canRedo();
}
bool anySelected(const Session& session) {
  return !session.selection.empty();
}

std::vector<ecs::Entity> selected(const Session& session) {
  return session.selection.entities(session.document);
}

void selectAll(Session& session, const std::vector<ecs::Entity>& entities) {
  std::vector<StableId> ids;
  for (const ecs::Entity entity : entities) ids.push_back(session.document.idOf(entity));
  session.selection.set(ids);
}

Answer replayed(Session& session, const Replay& replay) {
  for (const std::string& missing : replay.missing)
    session.log.warn(missing + " is not there now; it was passed over");
  return nlohmann::json{{"done", replay.done}, {"name", replay.name}, {"missing", replay.missing}};
}

Answer undo(Session& session, Words) {
  return replayed(session, session.history.undo());
}
Answer redo(Session& session, Words) {
  return replayed(session, session.history.redo());
}

Answer duplicateSelected(Session& session, Words) {
  const auto entities = selected(session);
  const auto copies = duplicate(session.document, session.history, entities);
  if (!copies) return failAgain(copies.error());
  selectAll(session, *copies);
  return nullptr;
}

Answer removeSelected(Session& session, Words) {
  const auto entities = selected(session);
  return answerOf(session.history.destroy(entities));
}

Answer copy(Session& session, Words words) {
  const ecs::Entity primary = session.selection.primaryEntity(session.document);
  const auto text = words.empty() ? copyEntities(session.document, selected(session))
                                  : copyComponent(session.document, primary, words[0]);
  if (!text) return failAgain(text.error());
  session.clipboard.put(*text);
  return nullptr;
}

Answer paste(Session& session, Words) {
  const std::string text = session.clipboard.get();
  const Clip clip = peekClip(text);
  if (clip.kind == Pasted::Component)
    return answerOf(pasteComponent(session.document, session.history, selected(session), text));
  const auto pasted = pasteEntities(session.document, session.history, ecs::Entity{}, text);
  if (!pasted) return failAgain(pasted.error());
  selectAll(session, *pasted);
  return nullptr;
}

Answer reset(Session& session, Words words) {
  const auto entities = selected(session);
  const std::string field = words.size() > 1 ? words[1] : std::string();
  if (!words.empty())
    return answerOf(resetToDefault(session.document, session.history, session.changes.baseline(), entities,
                                   words[0], field));
  session.history.begin("reset");
  for (const scene::ComponentInfo& component : scene::components())
    if (std::any_of(entities.begin(), entities.end(),
                    [&](ecs::Entity e) { return component.has(session.document.registry(), e); }))
      if (auto done = resetToDefault(session.document, session.history, session.changes.baseline(), entities,
                                     component.name);
          !done) {
        session.history.cancel();
        return failAgain(done.error());
      }
  session.history.commit();
  return nullptr;
}

Answer everything(Session& session, Words) {
  std::vector<StableId> ids;
  for (const TreeRow& row : session.tree.of(session.document))
    if (row.matches) ids.push_back(row.id);
  session.selection.set(ids);
  return ids.size();
}

Answer nothing(Session& session, Words) {
  session.selection.clear();
  return nullptr;
}

// Takes names, ids or filters of the tree. The first match comes last, so that it is the primary one.
Answer select(Session& session, Words words) {
  std::vector<ecs::Entity> found;
  for (const std::string& word : words) {
    const auto entities = findEntities(session, word);
    if (!entities) return failAgain(entities.error());
    found.insert(found.begin(), entities->begin(), entities->end());
  }
  selectAll(session, found);
  return found.size();
}

Answer rename(Session& session, Words words) {
  const ecs::Entity primary = session.selection.primaryEntity(session.document);
  if (!words.empty()) return answerOf(session.history.setField(primary, "Name", "name", words[0]));
  Dialog ask;
  ask.kind = Dialog::Kind::Text;
  ask.title = "Rename";
  ask.name = session.document.nameOf(primary);
  ask.answered = [](Session& s, const std::string& name) {
    const ecs::Entity entity = s.selection.primaryEntity(s.document);
    if (auto done = s.history.setField(entity, "Name", "name", name); !done) s.log.error(done.error());
  };
  session.window.dialog = std::move(ask);
  return nullptr;
}

constexpr std::size_t kMostSelected = 1000;

constexpr std::array kEditRows = {
    enabled(&canUndo, item("Edit", "undo", "Undo", "Ctrl+Z", "Take the last step back", &undo)),
    enabled(&canRedo, item("Edit", "redo", "Redo", "Ctrl+Shift+Z", "Do again what was taken back", &redo)),
    separator("Edit"),
    enabled(&anySelected,
            withWords("[COMPONENT]", 0, 1,
                      item("Edit", "copy", "Copy", "Ctrl+C",
                           "Copy what is selected; a component by its header in the inspector", &copy))),
    item("Edit", "paste", "Paste", "Ctrl+V", "Paste entities, or a component onto all that are selected",
         &paste),
    enabled(&anySelected, item("Edit", "duplicate", "Duplicate", "Ctrl+D",
                               "Copies of what is selected, beside it", &duplicateSelected)),
    enabled(&anySelected, item("Edit", "delete", "Delete", "Delete",
                               "Take away what is selected; what a bundle brought stays", &removeSelected)),
    enabled(&anySelected, withWords("NAME", 1, 1,
                                    item("Edit", "rename", "Rename...", "F2",
                                         "Another name for what is selected", &rename))),
    enabled(&anySelected, withWords("[COMPONENT [FIELD]]", 0, 2,
                                    item("Edit", "reset", "Reset to default", "Ctrl+R",
                                         "All fields of what is selected as the bundle has them", &reset))),
    separator("Edit"),
    item("Edit", "select-all", "Select all", "Ctrl+A", "All that the tree shows", &everything),
    item("Edit", "select-none", "Select none", "Ctrl+Shift+A", "Nothing is selected", &nothing),
    withWords(
        "NAME...", 1, kMostSelected,
        item("Edit", "select", "", "",
             "Select by name, id (id:0123...) or search (type:light); the first named is the primary one",
             &select)),
};

}  // namespace

std::span<const Command> editCommands() {
  return kEditRows;
}

}  // namespace lambent::editor
