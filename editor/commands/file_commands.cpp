#include <array>

#include "editor/commands/rows.hpp"
#include "editor/session/files.hpp"

namespace lambent::editor {

namespace {

Answer open(Session& session, Words words) {
  if (!words.empty()) return answerOf(session.files.open({words.begin(), words.end()}));
  Dialog ask;
  ask.kind = Dialog::Kind::OpenFile;
  ask.title = "Open";
  ask.kinds = {{"Scenes", {".gltf", ".glb"}}, {"Bundles", {".lmb.glb"}}, {"Worlds", {".json"}}};
  ask.folder = startFolder(session);
  ask.yes = "Open";
  ask.answered = [](Session& s, const std::string& file) { s.files.openLogged({file}); };
  session.window.dialog = std::move(ask);
  return nullptr;
}

Answer watch(Session& session, Words words) {
  if (!words.empty()) return answerOf(session.files.open({words[0]}));
  Dialog ask;
  ask.kind = Dialog::Kind::Folder;
  ask.title = "Open and watch a folder";
  ask.folder = startFolder(session);
  ask.yes = "Watch";
  ask.answered = [](Session& s, const std::string& folder) { s.files.openLogged({folder}); };
  session.window.dialog = std::move(ask);
  return nullptr;
}

Answer saveAs(Session& session, Words words) {
  if (!words.empty()) return answerOf(session.files.save(words[0]), {{"file", words[0]}});
  askWhereToSave(session);
  return nullptr;
}

Answer save(Session& session, Words words) {
  if (words.empty() && !session.files.world().empty())
    return answerOf(session.files.save(session.files.world()), {{"file", session.files.world().string()}});
  return saveAs(session, words);
}

Answer newWorld(Session& session, Words) {
  session.files.unlessUnsaved("The world has edits that are not saved. Begin a new one without them?",
                              [](Session& s) { s.files.closeAll(); });
  return nullptr;
}

Answer close(Session& session, Words words) {
  const auto entry = findScene(session, words.empty() ? std::string() : words[0]);
  if (!entry) return failAgain(entry.error());
  session.scene_steps.close(*entry);
  return nullptr;
}

Answer quit(Session& session, Words) {
  session.files.askToQuit();
  return nullptr;
}

constexpr std::size_t kMostFiles = 1000;

constexpr std::array kFileRows = {
    Command{.id = "new",
            .title = "New world",
            .menu = "File",
            .shortcut = "Ctrl+N",
            .help = "Close everything and begin anew",
            .arguments = "",
            .run = &newWorld},
    Command{.id = "open",
            .title = "Open...",
            .menu = "File",
            .shortcut = "Ctrl+O",
            .help = "Open scenes (.gltf, .glb), bundles (.lmb.glb) or a world (.json)",
            .arguments = "FILE...",
            .least_words = 1,
            .most_words = kMostFiles,
            .run = &open},
    Command{.id = "watch",
            .title = "Open and watch a folder...",
            .menu = "File",
            .shortcut = "Ctrl+Shift+O",
            .help = "Open all scenes of a folder, and bake what comes or changes there",
            .arguments = "FOLDER",
            .least_words = 1,
            .most_words = 1,
            .run = &watch},
    separator("File"),
    Command{.id = "save",
            .title = "Save world",
            .menu = "File",
            .shortcut = "Ctrl+S",
            .help = "Save what was edited, and which bundles stand here",
            .arguments = "[FILE]",
            .most_words = 1,
            .run = &save},
    Command{.id = "save-as",
            .title = "Save world as...",
            .menu = "File",
            .shortcut = "Ctrl+Shift+S",
            .help = "Save the world under another name",
            .arguments = "FILE",
            .least_words = 1,
            .most_words = 1,
            .run = &saveAs},
    separator("File"),
    Command{.id = "close",
            .title = "Close scene",
            .menu = "File",
            .shortcut = "Ctrl+W",
            .help = "Take the scene that is selected out of the world; its files stay, undo brings it back",
            .arguments = "[SCENE]",
            .most_words = 1,
            .run = &close,
            .enabled = &anyOpen},
    Command{.id = "quit",
            .title = "Quit",
            .menu = "File",
            .shortcut = "Ctrl+Q",
            .help = "End the editor; bakes go on where they were when it starts again",
            .arguments = "",
            .run = &quit},
};

}  // namespace

std::span<const Command> fileCommands() {
  return kFileRows;
}

}  // namespace lambent::editor
