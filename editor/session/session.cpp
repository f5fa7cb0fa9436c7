#include "editor/session/session.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include "runtime/scene/lights.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

namespace {

SceneSettings sceneSettings(const SessionOptions& options) {
  SceneSettings settings{.output_folder = options.output_folder,
                         .cache_folder = options.cache_folder,
                         .cache_bytes = options.cache_bytes,
                         .bake = options.bake,
                         .options = {}};
  settings.options.quality = options.quality;
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  settings.options.threads = options.threads != 0 ? options.threads : std::max(1u, cores - 1);
  return settings;
}

// Returns the folder of pictures in that of the cache, or an empty path without a cache.
std::filesystem::path pictureFolder(const SessionOptions& options) {
  const std::filesystem::path cache =
      options.cache_folder.empty() ? baker::Cache::defaultFolder() : options.cache_folder;
  return cache.empty() ? cache : cache / "pictures";
}

}  // namespace

Session::Session(const SessionOptions& options, Preferences given, Stage made)
    : preferences(std::move(given)),
      stage(std::move(made)),
      scenes(stage.world(), log, sceneSettings(options)),
      document(stage.world().registry()),
      history(document),
      asset_pictures(pictureFolder(options)) {
  document.adoptAll();
  WorldState world;
  for (const std::string& word : options.light_words) {
    const auto light = spec::parseLight(word);
    if (!light) continue;  // the command line has been checked
    if (spec::localLights(std::vector{*light}).empty())
      world.lights.push_back(word);
    else
      scene::addLights(stage.world().registry(), std::vector{*light});
  }
  if (options.light_words.empty())
    world.lights.assign(spec::kDefaultLights.begin(), spec::kDefaultLights.end());
  document.setWorld(std::move(world));
  document.adoptAll();
  handles.gizmo.options = preferences.handles;
}

Result<std::unique_ptr<Session>> Session::create(const SessionOptions& options, Preferences preferences) {
  auto stage = Stage::create(options.max_memory_bytes);
  if (!stage) return failAgain(stage.error());
  std::unique_ptr<Session> session(new Session(options, std::move(preferences), std::move(*stage)));
  session->followDocument();
  session->files.openLogged(options.files);
  session->scenes.findUnfinished();
  session->history.clear();
  return session;
}

void Session::followDocument() {
  if (document.worldVersion() == world_followed_) return;
  world_followed_ = document.worldVersion();
  for (const Error& error : stage.follow(document.world())) log.error(error);
  viewing.follow(document.world());
}

// Logs each error once, and again when it recurs.
void Session::logBundleErrors() {
  std::vector<std::string> wrong;
  for (const auto& [bundle, error] : stage.world().errors()) {
    wrong.push_back(error.line());
    if (std::find(told_.begin(), told_.end(), wrong.back()) == told_.end()) log.error(error);
  }
  told_ = std::move(wrong);
}

// Hands questions for files over to the desktop's dialog, and answers them with what it says. Should it fail,
// the question is asked in the window.
void Session::useDesktopDialogs() {
  using Kind = Dialog::Kind;
  if (auto closed = window.desktop_dialog.closed()) {
    if (!closed->answer) {
      log.warn(closed->answer.error().line() + "; the editor's own file dialogs are used");
      window.desktop_program.clear();
      window.dialog = std::move(closed->question);
    } else if (!closed->answer->empty() && closed->question.answered) {
      closed->question.answered(*this, *closed->answer);
    }
  }
  if (!window.dialog || window.desktop_program.empty() || !preferences.desktop_dialogs) return;
  if (window.dialog->kind == Kind::Confirm || window.dialog->kind == Kind::Text) return;
  // A second question while one is open elsewhere is dropped: the first must be answered or cancelled.
  Dialog asked = *std::exchange(window.dialog, std::nullopt);
  if (!window.desktop_dialog.open()) window.desktop_dialog.ask(window.desktop_program, std::move(asked));
}

void Session::update(double seconds) {
  useDesktopDialogs();
  if (scenes.update()) {
    document.adoptAll();
    scene_steps.update();
    viewing.changed = true;
  }
  logBundleErrors();
  followDocument();
  asset_pictures.update();
  if (playback.playing) {
    stage.world().playAnimations(static_cast<float>(seconds));
    playback.time_s += static_cast<float>(seconds);
  }
  stage.world().updateTransforms();
  viewing.update(document, seconds);
}

bool Session::awaitsScene() const {
  const auto waits = [](const SceneEntry& entry) { return !entry.slot && !entry.missing; };
  return scenes.busy() && std::ranges::any_of(scenes.entries(), waits);
}

bool Session::moving() const {
  const bool animated = playback.playing && document.registry().count<scene::AnimationComponent>() > 0;
  return viewing.changed || viewing.flying || animated || !picture.settled || picture.in_flight ||
         picture.preview_waits || (reference.on() && !reference.done()) || !measured();
}

bool Session::awaits() const {
  return scenes.busy() || window.desktop_dialog.open() || plans.busy() || assets.busy() ||
         asset_pictures.busy() || log.hasToasts();
}

}  // namespace lambent::editor
