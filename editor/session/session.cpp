#include "editor/session/session.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "runtime/scene/instantiate.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

Stage::Stage(frame::World world, lighting::Environment environment)
    : world_(std::move(world)), environment_(std::move(environment)) {
  environment_entity_ = scene::addEnvironment(world_.registry());
}

Result<Stage> Stage::create(std::uint64_t max_memory_bytes) {
  auto environment = lighting::Environment::create({});
  if (!environment) return failAgain(environment.error());
  return Stage(frame::World({.max_resident_bytes = max_memory_bytes}), std::move(*environment));
}

Result<void> Stage::followLights(const WorldState& state) {
  if (state.lights == words_ && state.fade_lights == fade_words_) return {};
  // The words are stored even if they fail, so that they are not loaded again in every frame.
  words_ = state.lights, fade_words_ = state.fade_lights;
  auto lights = spec::parseLights(state.lights);
  if (!lights) return failAgain(lights.error());
  auto fade_lights = spec::parseLights(state.fade_lights);
  if (!fade_lights) return failAgain(fade_lights.error());
  if (auto done = environment_.setLights(*lights, *fade_lights); !done) return done;
  lights_ = std::move(*lights), fade_lights_ = std::move(*fade_lights);
  followEnvironment();
  return {};
}

std::vector<Error> Stage::follow(const WorldState& state) {
  std::vector<Error> errors;
  if (auto done = followLights(state); !done) errors.push_back(done.error());
  std::vector<spec::KeyEdit> key_edits;
  for (const std::string& word : state.key_edits) {
    const auto edit = spec::parseKeyEdit(word);
    if (edit)
      key_edits.push_back(*edit);
    else
      errors.push_back(edit.error());
  }
  environment_.setKeyEdits(std::move(key_edits));
  frame::FrameSettings settings;
  for (const auto& [name, word] : state.settings)
    if (auto put = frame::putSetting(settings, name, word); !put) errors.push_back(put.error());
  settings.exposure_ev = state.exposure_ev;
  environment_.setMostKeys(settings.mostKeys());
  if (auto checked = frame::checkSettings(settings); checked)
    settings_ = settings;
  else
    errors.push_back(checked.error());
  return errors;
}

void Stage::followEnvironment() {
  const auto* component = world_.registry().tryGet<scene::EnvironmentComponent>(environment_entity_);
  if (component) environment_.follow(*component);
}

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

}  // namespace

Session::Session(const SessionOptions& options, Preferences given, Stage made)
    : preferences(std::move(given)),
      stage(std::move(made)),
      scenes(stage.world(), log, sceneSettings(options)),
      document(stage.world().registry()),
      history(document) {
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
}

Result<std::unique_ptr<Session>> Session::create(const SessionOptions& options, Preferences preferences) {
  auto stage = Stage::create(options.max_memory_bytes);
  if (!stage) return failAgain(stage.error());
  std::unique_ptr<Session> session(new Session(options, std::move(preferences), std::move(*stage)));
  session->followDocument();
  session->files.openLogged(options.files);
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

void Session::update(double seconds) {
  if (scenes.update()) {
    document.adoptAll();
    files.restoreAwaited();
    viewing.changed = true;
  }
  logBundleErrors();
  followDocument();
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
         (reference.on() && !reference.done()) || !measured();
}

Result<std::vector<ecs::Entity>> findEntities(const Session& session, const std::string& word) {
  TreeQuery query;
  query.filter =
      word.find(':') == std::string::npos && word.find(' ') != std::string::npos ? "\"" + word + "\"" : word;
  std::vector<ecs::Entity> whole, part;
  for (const TreeRow& row : treeRows(session.document, query)) {
    if (!row.matches) continue;
    part.push_back(row.entity);
    if (row.name == word) whole.push_back(row.entity);
  }
  if (!whole.empty()) return whole;
  if (!part.empty()) return part;
  return fail(word, "nothing of that name is there", "\"tree\" lists all there is");
}

std::optional<std::size_t> sceneAtHand(const Session& session) {
  const auto& entries = session.scenes.entries();
  if (entries.empty()) return std::nullopt;
  const ecs::Entity primary = session.selection.primaryEntity(session.document);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!entries[i].slot) continue;
    const scene::SceneInstance& instance = session.stage.world().instance(*entries[i].slot);
    if (primary == instance.root || isBelow(session.document.registry(), primary, instance.root)) return i;
    const auto holds = [&](const std::vector<ecs::Entity>& list) {
      return std::find(list.begin(), list.end(), primary) != list.end();
    };
    if (holds(instance.groups) || holds(instance.animations) || holds(instance.materials)) return i;
  }
  return 0;
}

Result<std::size_t> findScene(const Session& session, const std::string& word) {
  const auto& entries = session.scenes.entries();
  if (word.empty()) {
    if (const auto entry = sceneAtHand(session)) return *entry;
    return fail("scene", "none is open", "open one first");
  }
  std::vector<std::string> known;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].id == word || std::to_string(i) == word) return i;
    known.push_back(entries[i].id);
  }
  return fail(word, "is no open scene", fmt::format("open are: {}", fmt::join(known, ", ")));
}

}  // namespace lambent::editor
