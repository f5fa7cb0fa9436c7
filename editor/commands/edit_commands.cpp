#include <array>

#include "editor/commands/rows.hpp"
#include "editor/document/actions.hpp"

namespace lambent::editor {

namespace {

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

Result<void> duplicateSelected(Session& session) {
  return duplicate(session.document, session.history, selected(session))
      .map([&](const std::vector<ecs::Entity>& copies) { selectAll(session, copies); });
}

Result<void> copy(Session& session, Words words) {
  const ecs::Entity primary = session.selection.primaryEntity(session.document);
  return (words.empty() ? copyEntities(session.document, selected(session))
                        : copyComponent(session.document, primary, words[0]))
      .map([&](const std::string& text) { session.clipboard.put(text); });
}

Result<void> paste(Session& session) {
  const std::string text = session.clipboard.get();
  if (peekClip(text) == Pasted::Component)
    return pasteComponent(session.document, session.history, selected(session), text);
  return pasteEntities(session.document, session.history, ecs::Entity{}, text)
      .map([&](const std::vector<ecs::Entity>& pasted) { selectAll(session, pasted); });
}

Result<void> reset(Session& session, Words words) {
  const auto resetOne = [&](std::string_view component) {
    return resetToDefault(session.document, session.history, session.changes.baseline(), selected(session),
                          component, wordAt(words, 1));
  };
  if (!words.empty()) return resetOne(words[0]);
  session.history.begin("reset");
  for (const scene::ComponentInfo& component : scene::components())
    if (auto done = resetOne(component.name); !done) {
      session.history.cancel();
      return done;
    }
  session.history.commit();
  return {};
}

Answer everything(Session& session) {
  std::vector<StableId> ids;
  for (const TreeRow& row : session.tree.of(session.document))
    if (row.matches) ids.push_back(row.id);
  session.selection.set(ids);
  return ids.size();
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

Result<void> rename(Session& session, Words words) {
  const ecs::Entity primary = session.selection.primaryEntity(session.document);
  if (!words.empty()) return session.history.setField(primary, "Name", "name", words[0]);
  session.window.dialog = Dialog{
      .kind = Dialog::Kind::Text,
      .title = "Rename",
      .name = session.document.nameOf(primary),
      .answered = [](Session& s, const std::string& name) { runOrLog(s, "rename", std::array{name}); }};
  return {};
}

constexpr std::size_t kMostSelected = 1000;

}  // namespace

std::vector<Command> editCommands() {
  return inMenu(
      "Edit",
      {item("undo", "Undo", "Ctrl+Z", "Take the last step back",
            [](Session& session) { return replayed(session, session.history.undo()); })
           .onlyIf([](const Session& session) { return session.history.canUndo(); }),
       item("redo", "Redo", "Ctrl+Shift+Z", "Do again what was taken back",
            [](Session& session) { return replayed(session, session.history.redo()); })
           .onlyIf([](const Session& session) { return session.history.canRedo(); }),
       separator(),
       item("copy", "Copy", "Ctrl+C", "Copy what is selected; a component by its header in the inspector",
            copy)
           .taking("[COMPONENT]", 0, 1)
           .onlyIf(anySelected),
       item("paste", "Paste", "Ctrl+V", "Paste entities, or a component onto all that are selected", paste),
       item("duplicate", "Duplicate", "Ctrl+D", "Copies of what is selected, beside it", duplicateSelected)
           .onlyIf(anySelected),
       item("delete", "Delete", "Delete", "Take away what is selected; what a bundle brought stays",
            [](Session& session) { return session.history.destroy(selected(session)); })
           .onlyIf(anySelected),
       item("rename", "Rename...", "F2", "Another name for what is selected", rename)
           .taking("NAME", 1, 1)
           .onlyIf(anySelected),
       item("reset", "Reset to default", "Ctrl+R", "All fields of what is selected as the bundle has them",
            reset)
           .taking("[COMPONENT [FIELD]]", 0, 2)
           .onlyIf(anySelected),
       separator(), item("select-all", "Select all", "Ctrl+A", "All that the tree shows", everything),
       item("select-none", "Select none", "Ctrl+Shift+A", "Nothing is selected",
            [](Session& session) { session.selection.clear(); }),
       scripted("select",
                "Select by name, id (id:0123...) or search (type:light); the first named is the primary one",
                "NAME...", 1, kMostSelected, select)});
}

}  // namespace lambent::editor
