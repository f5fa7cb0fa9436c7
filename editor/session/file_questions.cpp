#include "editor/session/file_questions.hpp"

#include <string>
#include <utility>

#include "editor/session/session.hpp"

namespace lambent::editor {

namespace {

using Then = std::function<void(Session&)>;

// Returns the file of the first scene that is open, or an empty path.
std::filesystem::path openScene(const Session& session) {
  if (session.scenes.entries().empty()) return {};
  const SceneEntry& entry = session.scenes.entries().front();
  return entry.source.empty() ? entry.bundle : entry.source;
}

// Returns the name of the world's file, or one after the scene that is open.
std::string proposedName(const Session& session) {
  if (!session.files.world().empty()) return session.files.world().filename().string();
  std::string name = openScene(session).filename().string();
  return name.substr(0, name.find('.')).append(name.empty() ? "world.json" : ".json");
}

void save(Session& session, const std::filesystem::path& file, const Then& then) {
  if (auto saved = session.files.save(file); !saved) return session.log.error(saved.error());
  if (then) then(session);
}

// Saves to a file that was chosen in a dialog.
void saveChosen(Session& session, std::filesystem::path file, const Then& then) {
  if (file.extension() != ".json") file += ".json";
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored) || file == session.files.world())
    return save(session, file, then);
  Dialog ask;
  ask.title = "Replace the file?";
  ask.question = file.string() + " is there already. What it holds would be lost.";
  ask.yes = "Replace";
  ask.answered = [file, then](Session& s, const std::string&) { save(s, file, then); };
  session.window.dialog = std::move(ask);
}

}  // namespace

std::filesystem::path startFolder(const Session& session) {
  std::error_code ignored;
  if (!session.files.world().empty()) return session.files.world().parent_path();
  if (const std::filesystem::path scene = openScene(session); !scene.empty()) return scene.parent_path();
  if (!session.preferences.recent.empty())
    return std::filesystem::path(session.preferences.recent.front()).parent_path();
  return std::filesystem::current_path(ignored);
}

void askWhereToSave(Session& session, Then then) {
  Dialog ask;
  ask.kind = Dialog::Kind::SaveFile;
  ask.title = "Save the world";
  ask.kinds = {{"Worlds", {".json"}}};
  ask.folder = startFolder(session);
  ask.name = proposedName(session);
  ask.yes = "Save";
  ask.answered = [then = std::move(then)](Session& s, const std::string& file) { saveChosen(s, file, then); };
  session.window.dialog = std::move(ask);
}

}  // namespace lambent::editor
