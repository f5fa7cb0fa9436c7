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
    Command{.id = "undo",
            .title = "Undo",
            .menu = "Edit",
            .shortcut = "Ctrl+Z",
            .help = "Take the last step back",
            .arguments = "",
            .run = &undo,
            .enabled = &canUndo},
    Command{.id = "redo",
            .title = "Redo",
            .menu = "Edit",
            .shortcut = "Ctrl+Shift+Z",
            .help = "Do again what was taken back",
            .arguments = "",
            .run = &redo,
            .enabled = &canRedo},
    separator("Edit"),
    Command{.id = "copy",
            .title = "Copy",
            .menu = "Edit",
            .shortcut = "Ctrl+C",
            .help = "Copy what is selected; a component by its header in the inspector",
            .arguments = "[COMPONENT]",
            .most_words = 1,
            .run = &copy,
            .enabled = &anySelected},
    Command{.id = "paste",
            .title = "Paste",
            .menu = "Edit",
            .shortcut = "Ctrl+V",
            .help = "Paste entities, or a component onto all that are selected",
            .arguments = "",
            .run = &paste},
    Command{.id = "duplicate",
            .title = "Duplicate",
            .menu = "Edit",
            .shortcut = "Ctrl+D",
            .help = "Copies of what is selected, beside it",
            .arguments = "",
            .run = &duplicateSelected,
            .enabled = &anySelected},
    Command{.id = "delete",
            .title = "Delete",
            .menu = "Edit",
            .shortcut = "Delete",
            .help = "Take away what is selected; what a bundle brought stays",
            .arguments = "",
            .run = &removeSelected,
            .enabled = &anySelected},
    Command{.id = "rename",
            .title = "Rename...",
            .menu = "Edit",
            .shortcut = "F2",
            .help = "Another name for what is selected",
            .arguments = "NAME",
            .least_words = 1,
            .most_words = 1,
            .run = &rename,
            .enabled = &anySelected},
    Command{.id = "reset",
            .title = "Reset to default",
            .menu = "Edit",
            .shortcut = "Ctrl+R",
            .help = "All fields of what is selected as the bundle has them",
            .arguments = "[COMPONENT [FIELD]]",
            .most_words = 2,
            .run = &reset,
            .enabled = &anySelected},
    separator("Edit"),
    Command{.id = "select-all",
            .title = "Select all",
            .menu = "Edit",
            .shortcut = "Ctrl+A",
            .help = "All that the tree shows",
            .arguments = "",
            .run = &everything},
    Command{.id = "select-none",
            .title = "Select none",
            .menu = "Edit",
            .shortcut = "Ctrl+Shift+A",
            .help = "Nothing is selected",
            .arguments = "",
            .run = &nothing},
    Command{
        .id = "select",
        .title = "",
        .menu = "Edit",
        .shortcut = "",
        .help = "Select by name, id (id:0123...) or search (type:light); the first named is the primary one",
        .arguments = "NAME...",
        .least_words = 1,
        .most_words = kMostSelected,
        .run = &select},
};

}  // namespace

std::span<const Command> editCommands() {
  return kEditRows;
}

}  // namespace lambent::editor
