#include "editor/session/files.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "editor/session/session.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

namespace {

// Returns the edits that lack something: those of entities that do not exist, and the parents of others that
// were below them.
Overrides lacking(const Document& document, Overrides all) {
  Overrides gone;
  for (EntityOverride& edit : all) {
    if (!document.find(edit.id)) {
      gone.push_back(std::move(edit));
    } else if (edit.parent && *edit.parent != kNoId && !document.find(*edit.parent)) {
      EntityOverride hung;
      hung.id = edit.id, hung.name = edit.name, hung.parent = edit.parent;
      gone.push_back(std::move(hung));
    }
  }
  return gone;
}

// Returns whether something is shown of each scene that is open.
bool allShown(const Session& session) {
  return std::ranges::all_of(session.scenes.entries(),
                             [](const SceneEntry& scene) { return scene.slot.has_value(); });
}

bool namesWorld(const std::filesystem::path& path) {
  return path.extension() == ".json";
}

}  // namespace

bool Files::asksToOpen(const std::vector<std::filesystem::path>& paths) {
  if (!modified()) return false;
  // A file that cannot be read takes no place, so nothing needs to be asked for it.
  const auto world = std::ranges::find_if(
      paths, [](const std::filesystem::path& path) { return namesWorld(path) && loadWorldFile(path); });
  if (world == paths.end()) return false;
  unlessUnsaved(fmt::format("The world has edits that are not saved. Open {} without them?",
                            world->filename().string()),
                [paths](Session& session) { session.files.openAll(paths); });
  return true;
}

Result<void> Files::open(const std::vector<std::filesystem::path>& paths) {
  if (asksToOpen(paths)) return {};
  for (const std::filesystem::path& path : paths)
    if (auto opened = openNow(path); !opened) return opened;
  return {};
}

void Files::openLogged(const std::vector<std::filesystem::path>& paths) {
  if (!asksToOpen(paths)) openAll(paths);
}

void Files::openAll(const std::vector<std::filesystem::path>& paths) {
  for (const std::filesystem::path& path : paths)
    if (auto opened = openNow(path); !opened) session_.log.error(opened.error());
}

Result<void> Files::openNow(const std::filesystem::path& path) {
  if (namesWorld(path)) {
    auto file = loadWorldFile(path);
    if (!file) return failAgain(file.error());
    openWorld(path, std::move(*file));
    return {};
  }
  const bool first = session_.scenes.entries().empty();
  if (auto opened = session_.scenes.open(path); !opened) return opened;
  session_.document.adoptAll();
  session_.preferences.addRecent(path);
  if (first) session_.viewing.frame_when_loaded = true;
  return {};
}

void Files::openWorld(const std::filesystem::path& path, WorldFile file) {
  closeAll();
  Log& log = session_.log;
  for (const BundleEntry& bundle : file.state.bundles) session_.scenes.open(bundle, path.parent_path());
  for (const std::string& notice : file.notices) log.warn(path.string() + ": " + notice);
  if (!file.notices.empty()) session_.window.wanted_panels.emplace_back("Log");  // saving would lose these
  const ApplyReport applied = applyWorld(session_.document, file);
  awaited_ = lacking(session_.document, file.entities);
  if (!allShown(session_)) {
    if (!awaited_.empty())
      log.note(fmt::format("{}: edits of {} objects wait for their scene", path.string(), awaited_.size()));
  } else {
    for (const std::string& missing : applied.missing)
      log.warn(path.string() + ": " + missing + " is not there any more; its edits wait");
  }
  bundles_ = std::move(file.state.bundles);
  world_ = path;
  session_.history.clear();
  session_.preferences.addRecent(path);
  session_.followDocument();
}

// Stores the state of the scenes and the camera in the document before it is saved.
void Files::keepWorldState() {
  WorldState world = session_.document.world();
  world.bundles = session_.scenes.state(world_.parent_path());
  session_.viewing.keep(world);
  session_.document.setWorld(std::move(world));
}

Result<void> Files::save(const std::filesystem::path& path) {
  const std::filesystem::path before = world_;
  world_ = std::filesystem::absolute(path);
  keepWorldState();
  const WorldFile file = captureWorld(session_.document, session_.changes.baseline(), awaited_);
  if (auto saved = saveWorldFile(world_, file); !saved) {
    world_ = before;
    return saved;
  }
  bundles_ = file.state.bundles;
  session_.history.markSaved();
  session_.preferences.addRecent(world_);
  return {};
}

Result<std::filesystem::path> Files::rescue() {
  if (!modified()) return std::filesystem::path();
  std::filesystem::path rescued = world_.empty() ? "world.json" : world_;
  rescued.replace_extension(".rescued.json");
  if (auto saved = save(rescued); !saved) return failAgain(saved.error());
  return rescued;
}

void Files::close(std::size_t entry) {
  const SceneEntry closed = session_.scenes.entries()[entry];
  unlessUnsaved(fmt::format("Edits of {} that are not saved are lost. Close it?", closed.id),
                [closed](Session& session) {
                  const auto& scenes = session.scenes.entries();
                  const auto is_it = [&](const SceneEntry& other) { return other.isSame(closed); };
                  const auto found = std::ranges::find_if(scenes, is_it);
                  if (found == scenes.end()) return;
                  session.scenes.close(static_cast<std::size_t>(found - scenes.begin()));
                  // Edits that still wait while all scenes are there are those of a closed scene.
                  if (allShown(session)) session.files.awaited_.clear();
                });
}

void Files::restoreAwaited() {
  Overrides here;
  for (const EntityOverride& edit : awaited_)
    if (session_.document.find(edit.id)) here.push_back(edit);
  if (here.empty()) return;
  applyOverrides(session_.document, here);
  awaited_ = lacking(session_.document, std::move(awaited_));
  session_.viewing.changed = true;
}

void Files::closeAll() {
  Document& document = session_.document;
  const ecs::Entity environment = session_.stage.environmentEntity();
  session_.scenes.closeAll();
  awaited_.clear();
  session_.selection.clear();
  std::vector<ecs::Entity> created;
  for (const auto [entity, mark] : document.registry().view<const Created>()) created.push_back(entity);
  for (const ecs::Entity entity : created)
    if (entity != environment) document.registry().destroy(entity);
  WorldState world;
  world.lights.assign(spec::kDefaultLights.begin(), spec::kDefaultLights.end());
  document.registry().edit<scene::EnvironmentComponent>(environment) = {};
  document.setWorld(std::move(world));
  world_.clear();
  bundles_.clear();
  session_.history.clear();
  session_.viewing.frame_when_loaded = true;
}

bool Files::modified() const {
  const auto same = [](const SceneEntry& scene, const BundleEntry& bundle) {
    return scene.id == bundle.id && scene.instance == bundle.instance;
  };
  return session_.history.modified() ||
         (!world_.empty() && !std::ranges::equal(session_.scenes.entries(), bundles_, same));
}

void Files::unlessUnsaved(std::string question, std::function<void(Session&)> then) {
  if (!modified()) return then(session_);
  Dialog ask;
  ask.kind = Dialog::Kind::Confirm;
  ask.title = "Not saved";
  ask.question = std::move(question);
  ask.yes = "Discard", ask.no = "Cancel", ask.third = "Save";
  ask.answered = [then](Session& session, const std::string&) { then(session); };
  ask.third_chosen = [then](Session& session) {
    Files& files = session.files;
    if (files.world().empty()) return askWhereToSave(session, then);
    if (auto saved = files.save(files.world()); !saved) return session.log.error(saved.error());
    then(session);
  };
  session_.window.dialog = std::move(ask);
}

void Files::askToQuit() {
  unlessUnsaved("The world has edits that are not saved. Quit without them?",
                [](Session& session) { session.window.quit = true; });
}

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
  ask.endings = {".json"};
  ask.folder = startFolder(session);
  ask.name = proposedName(session);
  ask.yes = "Save";
  ask.answered = [then = std::move(then)](Session& s, const std::string& file) { saveChosen(s, file, then); };
  session.window.dialog = std::move(ask);
}

}  // namespace lambent::editor
