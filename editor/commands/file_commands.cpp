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

Answer assets(Session& session, Words words) {
  session.assets.updateNow(session);
  if (!words.empty()) session.assets.search = words[0];
  Answer answer = nlohmann::json::array();
  for (const AssetGroup& group : session.assets.groups())
    for (const Asset& asset : group.assets)
      if (matches(asset, session.assets.search))
        answer->push_back({{"name", asset.file.filename().string()},
                           {"kind", kindWord(asset.kind)},
                           {"file", asset.file.string()},
                           {"bytes", asset.bytes},
                           {"group", group.title}});
  return answer;
}

Answer useAsset(Session& session, Words words) {
  std::optional<Asset> asset = assetAt(words[0]);
  if (!asset) {
    session.assets.updateNow(session);
    if (const Asset* listed = session.assets.find(words[0])) asset = *listed;
  }
  if (!asset) return fail(words[0], "is no asset", "\"assets\" lists them");
  if (asset->kind == AssetKind::EnvironmentMap)
    return runCommand(session, "environment-map", std::array{asset->file.string()});
  return answerOf(session.files.open({asset->file}));
}

constexpr std::array kFileRows = {
    item("File", "new", "New world", "Ctrl+N", "Close everything and begin anew", &newWorld),
    withWords("FILE...", 1, kMostFiles,
              item("File", "open", "Open...", "Ctrl+O",
                   "Open scenes (.gltf, .glb), bundles (.lmb.glb) or a world (.json)", &open)),
    withWords("FOLDER", 1, 1,
              item("File", "watch", "Open and watch a folder...", "Ctrl+Shift+O",
                   "Open all scenes of a folder, and bake what comes or changes there", &watch)),
    separator("File"),
    withWords("[FILE]", 0, 1,
              item("File", "save", "Save world", "Ctrl+S",
                   "Save what was edited, and which bundles stand here", &save)),
    withWords("FILE", 1, 1,
              item("File", "save-as", "Save world as...", "Ctrl+Shift+S", "Save the world under another name",
                   &saveAs)),
    separator("File"),
    enabled(&anyOpen,
            withWords(
                "[SCENE]", 0, 1,
                item("File", "close", "Close scene", "Ctrl+W",
                     "Take the scene that is selected out of the world; its files stay, undo brings it back",
                     &close))),
    item("File", "quit", "Quit", "Ctrl+Q", "End the editor; bakes go on where they were when it starts again",
         &quit),
    scripted("assets", "Environment maps, scenes, bundles and worlds to choose from, searched", "[SEARCH]", 0,
             1, &assets),
    scripted("use-asset", "Light from this environment map; open this scene, bundle or world", "FILE", 1, 1,
             &useAsset),
};

}  // namespace

std::span<const Command> fileCommands() {
  return kFileRows;
}

}  // namespace lambent::editor
