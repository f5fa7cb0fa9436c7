#include <array>

#include "editor/commands/rows.hpp"

namespace lambent::editor {

namespace {

// Returns the file of the first scene that is open, or an empty path.
std::filesystem::path openScene(const Session& session) {
  if (session.scenes.entries().empty()) return {};
  const SceneEntry& entry = session.scenes.entries().front();
  return entry.source.empty() ? entry.bundle : entry.source;
}

std::filesystem::path startFolder(const Session& session) {
  std::error_code ignored;
  if (!session.files.world().empty()) return session.files.world().parent_path();
  if (const std::filesystem::path scene = openScene(session); !scene.empty()) return scene.parent_path();
  if (!session.preferences.recent.empty())
    return std::filesystem::path(session.preferences.recent.front()).parent_path();
  return std::filesystem::current_path(ignored);
}

Answer open(Session& session, Words words) {
  if (!words.empty()) {
    for (const std::string& file : words)
      if (auto opened = session.files.open(file); !opened) return failAgain(opened.error());
    return nullptr;
  }
  Dialog ask;
  ask.kind = Dialog::Kind::OpenFile;
  ask.title = "Open";
  ask.kinds = {{"Scenes", {".gltf", ".glb"}}, {"Bundles", {".lmb.glb"}}, {"Worlds", {".json"}}};
  ask.folder = startFolder(session);
  ask.yes = "Open";
  ask.answered = [](Session& s, const std::string& file) { s.files.openLogged(file); };
  session.window.dialog = std::move(ask);
  return nullptr;
}

Answer watch(Session& session, Words words) {
  if (!words.empty()) return answerOf(session.files.open(words[0]));
  Dialog ask;
  ask.kind = Dialog::Kind::Folder;
  ask.title = "Open and watch a folder";
  ask.folder = startFolder(session);
  ask.yes = "Watch";
  ask.answered = [](Session& s, const std::string& folder) { s.files.openLogged(folder); };
  session.window.dialog = std::move(ask);
  return nullptr;
}

// Returns the name of the world's file, or one after the scene that is open.
std::string proposedName(const Session& session) {
  if (!session.files.world().empty()) return session.files.world().filename().string();
  std::string name = openScene(session).filename().string();
  return name.substr(0, name.find('.')).append(name.empty() ? "world.json" : ".json");
}

void saveLogged(Session& session, const std::filesystem::path& file) {
  if (auto saved = session.files.save(file); !saved) session.log.error(saved.error());
}

// Saves to a file that was chosen in a dialog. Another file of that name is not replaced unasked.
void saveChosen(Session& session, std::filesystem::path file) {
  if (file.extension() != ".json") file += ".json";
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored) || file == session.files.world())
    return saveLogged(session, file);
  Dialog ask;
  ask.title = "Replace the file?";
  ask.question = file.string() + " is there already. What it holds would be lost.";
  ask.yes = "Replace";
  ask.answered = [file](Session& s, const std::string&) { saveLogged(s, file); };
  session.window.dialog = std::move(ask);
}

Answer saveAs(Session& session, Words words) {
  if (!words.empty()) return answerOf(session.files.save(words[0]), {{"file", words[0]}});
  Dialog ask;
  ask.kind = Dialog::Kind::SaveFile;
  ask.title = "Save the world";
  ask.kinds = {{"Worlds", {".json"}}};
  ask.folder = startFolder(session);
  ask.name = proposedName(session);
  ask.yes = "Save";
  ask.answered = [](Session& s, const std::string& file) { saveChosen(s, file); };
  session.window.dialog = std::move(ask);
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

bool anyOpen(const Session& session) {
  return !session.scenes.entries().empty();
}

constexpr std::size_t kMany = 1000;

constexpr std::array kRows = {
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
            .most_words = kMany,
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
  return kRows;
}

}  // namespace lambent::editor
