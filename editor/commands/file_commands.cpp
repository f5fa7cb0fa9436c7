// Implements the commands for files and for bakes of scenes.
#include <array>

#include "editor/commands/rows.hpp"
#include "editor/session/files.hpp"

namespace lambent::editor {

namespace {

Result<void> open(Session& session, Words words) {
  if (!words.empty()) return session.files.open({words.begin(), words.end()});
  session.window.dialog =
      Dialog{.kind = Dialog::Kind::OpenFile,
             .title = "Open",
             .endings = {".gltf", ".glb", ".json"},
             .folder = startFolder(session),
             .yes = "Open",
             .answered = [](Session& s, const std::string& file) { s.files.openLogged({file}); }};
  return {};
}

Result<void> watch(Session& session, Words words) {
  if (!words.empty()) return session.files.open({words[0]});
  session.window.dialog =
      Dialog{.kind = Dialog::Kind::Folder,
             .title = "Open and watch a folder",
             .folder = startFolder(session),
             .yes = "Watch",
             .answered = [](Session& s, const std::string& folder) { s.files.openLogged({folder}); }};
  return {};
}

// Saves to the file that is named or, without a name, to this one. Asks where neither is.
Answer saveTo(Session& session, Words words, const std::filesystem::path& present) {
  const std::filesystem::path file = words.empty() ? present : std::filesystem::path(words[0]);
  if (file.empty()) {
    askWhereToSave(session);
    return nullptr;
  }
  if (const auto saved = session.files.save(file); !saved) return failAgain(saved.error());
  return nlohmann::json{{"file", file.string()}};
}

constexpr std::size_t kMostFiles = 1000;

}  // namespace

std::vector<Command> fileCommands() {
  return inMenu(
      "File",
      {item("new", "New world", "Ctrl+N", "Close everything and begin anew",
            [](Session& session) {
              session.files.unlessUnsaved(
                  "The world has edits that are not saved. Begin a new one without them?",
                  [](Session& s) { s.files.closeAll(); });
            }),
       item("open", "Open...", "Ctrl+O", "Open scenes (.gltf, .glb), bundles (.lmb.glb) or a world (.json)",
            open)
           .taking("FILE...", 1, kMostFiles),
       item("watch", "Open and watch a folder...", "Ctrl+Shift+O",
            "Open all scenes of a folder, and bake what comes or changes there", watch)
           .taking("FOLDER", 1, 1),
       separator(),
       item("save", "Save world", "Ctrl+S", "Save what was edited, and which bundles stand here",
            [](Session& session, Words words) { return saveTo(session, words, session.files.world()); })
           .taking("[FILE]", 0, 1),
       item("save-as", "Save world as...", "Ctrl+Shift+S", "Save the world under another name",
            [](Session& session, Words words) { return saveTo(session, words, {}); })
           .taking("FILE", 1, 1),
       separator(),
       item("close", "Close scene", "Ctrl+W",
            "Take the scene that is selected out of the world; its files stay",
            [](Session& session, Words words) {
              return findScene(session, wordAt(words, 0)).map([&](std::size_t entry) {
                session.files.close(entry);
              });
            })
           .taking("[SCENE]", 0, 1)
           .onlyIf(anyOpen),
       item("quit", "Quit", "Ctrl+Q", "End the editor; bakes go on where they were when it starts again",
            [](Session& session) { session.files.askToQuit(); })});
}

namespace {

Result<void> bake(Session& session, Words words) {
  return findScene(session, wordAt(words, 0)).and_then([&](std::size_t entry) {
    return session.scenes.bake(entry, session.changes.editsOf(entry));
  });
}

Result<void> bakeAll(Session& session) {
  Result<void> first_failed;  // which keeps the others from nothing
  for (std::size_t i = 0; i < session.scenes.entries().size(); ++i) {
    if (session.scenes.entries()[i].source.empty()) continue;
    if (auto asked = session.scenes.bake(i, session.changes.editsOf(i)); !asked && first_failed)
      first_failed = std::move(asked);
  }
  return first_failed;
}

Result<void> cancel(Session& session, Words words) {
  if (!words.empty())
    return findScene(session, words[0]).map([&](std::size_t entry) { session.scenes.cancel(entry); });
  for (std::size_t i = 0; i < session.scenes.entries().size(); ++i) session.scenes.cancel(i);
  return {};
}

Result<void> option(Session& session, Words words) {
  return findScene(session, wordAt(words, 2)).and_then([&](std::size_t entry) {
    return session.scenes.setOption(entry, words[0], words[1]);
  });
}

}  // namespace

std::vector<Command> bakeCommands() {
  return inMenu(
      "Bake",
      {item("bake", "Bake", "F7",
            "Bake the scene at hand with what was edited; what did not change is not traced again", bake)
           .taking("[SCENE]", 0, 1)
           .onlyIf(anyOpen),
       item("bake-all", "Bake all", "Shift+F7", "Bake all scenes with what was edited", bakeAll)
           .onlyIf(anyOpen),
       item("cancel", "Cancel", "Ctrl+F7",
            "Stop baking; what was done is kept, and the next bake goes on from there", cancel)
           .taking("[SCENE]", 0, 1)
           .onlyIf([](const Session& session) { return session.scenes.busy(); }),
       scripted("bake-option", "An option of `lambent bake` for a scene, by its name without the dashes",
                "NAME VALUE [SCENE]", 2, 3, option)});
}

}  // namespace lambent::editor
