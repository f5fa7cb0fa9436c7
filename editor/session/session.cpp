#include "editor/session/session.hpp"

#include <algorithm>
#include <thread>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "editor/session/moved_parts.hpp"
#include "runtime/scene/bounds.hpp"
#include "runtime/scene/lights.hpp"
#include "runtime/scene/materials.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/world/material_rebake.hpp"

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
  for (const std::filesystem::path& file : options.files) session->openLogged(file);
  if (options.bake) session->scenes.resume();
  session->history.clear();
  return session;
}

// ---- once a frame

void Session::followDocument() {
  if (document.worldVersion() == world_followed_) return;
  world_followed_ = document.worldVersion();
  for (const Error& error : stage.follow(document.world())) log.error(error);
  viewing.follow(document.world());
}

void Session::update(double seconds) {
  if (scenes.update()) {
    document.adoptAll();
    scene_steps.update();
    frames_to_draw_ = 1;
  }
  std::vector<std::string> wrong;
  for (const auto& [bundle, error] : stage.world().errors()) {
    wrong.push_back(error.line());
    if (std::find(told_.begin(), told_.end(), wrong.back()) == told_.end()) log.error(error);
  }
  told_ = std::move(wrong);
  followDocument();
  if (viewing.playing) {
    stage.world().playAnimations(static_cast<float>(seconds));
    viewing.animation_s += static_cast<float>(seconds);
  }
  stage.world().updateTransforms();
  viewing.update(*this, seconds);
}

void Session::render(spec::Size size) {
  viewing.size = size;
  const auto view = viewing.view(*this, size);
  if (!view) return log.error(view.error());
  viewing.shown_view = *view;
  const bool resized = size.width != size_drawn_.width || size.height != size_drawn_.height;
  // Another size has another aspect, by a pixel at least. That is no movement: where whole pictures take
  // long, the next would be drawn coarse for it, at another size again, and so on for ever.
  const bool moved = view->view_from_world != view_drawn_.view_from_world ||
                     (!resized && view->clip_from_view != view_drawn_.clip_from_view) ||
                     edits_drawn_ != editsVersion();
  if (moved || resized || !stage.atRest() || viewing.changed) frames_to_draw_ = 1;
  if (!moved && !viewing.playing && !history.open()) viewing.settle();
  if (frames_to_draw_ > 0 || viewing.playing) {
    frames_to_draw_ = 0;
    viewing.changed = false;
    view_drawn_ = *view, size_drawn_ = size, edits_drawn_ = editsVersion();
    stage.frame().setOverlays(overlaysNow());
    const auto before = std::chrono::steady_clock::now();
    if (auto drawn = stage.render(*view, size); !drawn) log.error(drawn.error());
    glFinish();  // what a picture takes decides how large the next may be
    const double ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
    stage.addTime(ms);
    viewing.tookTime(ms, moved || viewing.playing || history.open());
  }
  reference.update(*this);
  settings.update(*this);
  qualities.update(*this);
}

bool Session::moving() const {
  return frames_to_draw_ > 0 || (viewing.playing && viewing.hasAnimations(*this)) || !stage.atRest() ||
         (reference.on() && !reference.done()) || viewing.flying || !measured();
}

// Of the residency, those that hold anything that is selected.
std::vector<std::uint32_t> Session::selectedGroups() const {
  std::vector<std::uint32_t> found;
  const ecs::Registry& registry = document.registry();
  const std::vector<ecs::Entity> selected = selection.entities(document);
  const auto& groups = stage.world().residency().groups();
  const auto add = [&](const scene::RigidGroupComponent& group) {
    for (std::uint32_t i = 0; i < groups.size(); ++i)
      if (groups[i].bundle == group.bundle && groups[i].index == group.group) found.push_back(i);
  };
  for (const ecs::Entity entity : selected)
    if (const auto* group = registry.tryGet<scene::RigidGroupComponent>(entity)) add(*group);
  for (const auto [draw, item] : registry.view<const scene::DrawItem>())
    for (const ecs::Entity entity : selected)
      if (draw == entity || isBelow(registry, item.node, entity))
        if (const auto* group = registry.tryGet<scene::RigidGroupComponent>(item.group)) add(*group);
  return found;
}

// What is asked for, and a box around what is selected.
frame::OverlayOptions Session::overlaysNow() const {
  frame::OverlayOptions overlays = viewing.overlays;
  if (overlays.neighborhoods) overlays.foremost_groups = selectedGroups();
  overlays.key = viewing.key_at_hand;
  if (!viewing.show_gizmos) return overlays;
  const scene::Box box = selectionBounds();
  if (box.empty()) return overlays;
  constexpr glm::vec4 kColor(1.0f, 0.62f, 0.2f, 0.9f);
  const auto corner = [&](int i) {
    return glm::vec3((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                     (i & 4) != 0 ? box.max.z : box.min.z);
  };
  for (int i = 0; i < 8; ++i)
    for (const int bit : {1, 2, 4})
      if ((i & bit) == 0) overlays.lines.push_back({corner(i), corner(i | bit), kColor});
  return overlays;
}

// Of all that edits and picks change in the picture.
std::uint64_t Session::editsVersion() const {
  return history.version() + selection.version();
}

// ---- files

void Session::openLogged(const std::filesystem::path& path) {
  if (auto opened = open(path); !opened) log.error(opened.error());
}

Result<void> Session::open(const std::filesystem::path& path) {
  if (path.extension() == ".json") return openWorld(path);
  const bool first = scenes.entries().empty();
  if (auto opened = scene_steps.open(path); !opened) return opened;
  preferences.addRecent(path);
  if (first) viewing.frame_when_loaded = true;
  return {};
}

Result<void> Session::openWorld(const std::filesystem::path& path) {
  auto file = loadWorldFile(path);
  if (!file) return failAgain(file.error());
  newWorld();
  for (const BundleEntry& bundle : file->state.bundles)
    if (auto opened = scenes.open(bundle, path.parent_path()); !opened) log.error(opened.error());
  for (const std::string& notice : file->notices) log.warn(path.string() + ": " + notice);
  for (const std::string& missing : applyWorld(document, *file).missing)
    log.warn(path.string() + ": " + missing + " is not there any more; its edits wait");
  loaded_world_ = std::move(*file);
  world_file_ = path;
  history.clear();
  preferences.addRecent(path);
  followDocument();
  return {};
}

// What the windows know and the document does not, before it is saved.
void Session::keepWorldState() {
  WorldState world = document.world();
  world.bundles = scenes.state(world_file_.parent_path());
  viewing.keep(world);
  document.setWorld(std::move(world));
}

Result<void> Session::save(const std::filesystem::path& path) {
  const std::filesystem::path before = world_file_;
  world_file_ = std::filesystem::absolute(path);
  keepWorldState();
  const WorldFile file = captureWorld(document, baseline(), loaded_world_ ? &*loaded_world_ : nullptr);
  if (auto saved = saveWorldFile(world_file_, file); !saved) {
    world_file_ = before;
    return saved;
  }
  history.markSaved();
  preferences.addRecent(world_file_);
  return {};
}

void Session::newWorld() {
  scenes.closeAll();
  scene_steps.clear();
  selection.clear();
  const auto made = document.registry().view<const Created>();
  std::vector<ecs::Entity> created;
  for (const auto [entity, mark] : made) created.push_back(entity);
  for (const ecs::Entity entity : created)
    if (entity != stage.environmentEntity()) document.registry().destroy(entity);
  WorldState world;
  world.lights.assign(spec::kDefaultLights.begin(), spec::kDefaultLights.end());
  document.registry().edit<scene::EnvironmentComponent>(stage.environmentEntity()) = {};
  document.setWorld(std::move(world));
  world_file_.clear();
  loaded_world_.reset();
  history.clear();
  viewing.frame_when_loaded = true;
}

bool Session::modified() const {
  return world_file_.empty() ? history.modifiedInside() : history.modified();
}

void Session::unlessUnsaved(std::string question, std::function<void(Session&)> then) {
  if (!modified()) return then(*this);
  Dialog ask;
  ask.kind = Dialog::Kind::Confirm;
  ask.title = "Not saved";
  ask.question = std::move(question);
  ask.yes = "Discard", ask.no = "Cancel", ask.third = "Save";
  ask.answered = [then](Session& session, const std::string&) { then(session); };
  ask.third_chosen = [then](Session& session) {
    if (session.world_file_.empty()) {
      session.log.warn("the world has no file yet: save it with File > Save as");
      return;
    }
    if (auto saved = session.save(session.world_file_); !saved) return session.log.error(saved.error());
    then(session);
  };
  dialog = std::move(ask);
}

void Session::askToQuit() {
  unlessUnsaved("The world has edits that are not saved. Quit without them?",
                [](Session& s) { s.quit = true; });
}

// ---- the world

const Baseline& Session::baseline() {
  std::vector<BaselineBundle> bundles;
  // A bundle that takes another's place does so some frames after the scenes' version has risen.
  std::pair<std::uint64_t, std::vector<const void*>> of{scenes.version(), {}};
  for (const SceneEntry& entry : scenes.entries())
    if (entry.slot) {
      bundles.push_back({&stage.world().description(*entry.slot), entry.id, 0});
      of.second.push_back(bundles.back().description);
    }
  if (of == baseline_of_) return baseline_;
  auto made = Baseline::create(bundles);
  if (made)
    baseline_ = std::move(*made);
  else
    log.error(made.error());
  baseline_of_ = std::move(of);
  return baseline_;
}

std::optional<std::size_t> Session::entryAtHand() const {
  const auto& entries = scenes.entries();
  if (entries.empty()) return std::nullopt;
  const ecs::Entity primary = selection.primaryEntity(document);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!entries[i].slot) continue;
    const scene::SceneInstance& instance = stage.world().instance(*entries[i].slot);
    if (primary == instance.root || isBelow(document.registry(), primary, instance.root)) return i;
    const auto holds = [&](const std::vector<ecs::Entity>& list) {
      return std::find(list.begin(), list.end(), primary) != list.end();
    };
    if (holds(instance.groups) || holds(instance.draws) || holds(instance.animations)) return i;
  }
  return 0;
}

scene::Box Session::selectionBounds() const {
  scene::Box bounds;
  const ecs::Registry& registry = document.registry();
  for (const ecs::Entity selected : selection.entities(document)) {
    if (registry.has<scene::RigidGroupComponent>(selected))
      bounds.add(scene::groupBounds(registry, selected));
    for (const auto [draw, item] : registry.view<const scene::DrawItem>())
      if (draw == selected || item.node == selected || isBelow(registry, item.node, selected))
        bounds.add(scene::drawBounds(registry, draw));
    if (bounds.empty() && registry.has<scene::Transform>(selected)) {
      const glm::vec3 at(worldFromNode(registry, selected)[3]);
      const auto* light = registry.tryGet<scene::LocalLightComponent>(selected);
      const glm::vec3 around(light ? std::max(0.1f, light->radius_m) : 0.1f);
      bounds.add(at - around), bounds.add(at + around);
    }
  }
  return bounds;
}

std::vector<std::string> Session::needsRebake(std::size_t entry) const {
  std::vector<std::string> sentences;
  const SceneEntry& scene = scenes.entries()[entry];
  if (!scene.slot) return sentences;
  const bundle::Description& description = stage.world().description(*scene.slot);
  const scene::SceneInstance& instance = stage.world().instance(*scene.slot);
  for (std::uint32_t i = 0; i < instance.materials.size(); ++i) {
    const auto* component = document.registry().tryGet<scene::MaterialComponent>(instance.materials[i]);
    if (!component) continue;
    const gltf::Material now = scene::withComponent(description.materials[i], *component);
    for (const frame::RebakeReason& reason :
         frame::needsRebake(now, description.materials[i], frame::materialUse(description, i)))
      sentences.push_back(fmt::format("{}: {}", description.materials[i].name, reason.sentence));
  }
  addMovedParts(document.registry(), description, instance, sentences);
  return sentences;
}

const std::vector<std::string>& Session::needsRebakeNow(std::size_t entry) {
  // Until all is loaded, a bundle may take another's place in any frame.
  const Rebake now{entry, history.version(), scenes.version()};
  if (rebake_of_ == now && stage.world().loaded()) return rebake_;
  rebake_ = needsRebake(entry);
  rebake_of_ = stage.world().loaded() ? std::optional(now) : std::nullopt;
  return rebake_;
}

const std::vector<TreeRow>& Session::treeRowsNow() {
  const std::uint64_t version = treeVersion(document.registry());
  const bool same = version == rows_version_ && rows_of_.filter == tree.filter &&
                    rows_of_.closed == tree.closed && rows_of_.show_parts == tree.show_parts;
  if (same) return rows_;
  rows_ = treeRows(document, tree);
  rows_of_ = tree;
  rows_version_ = version;
  return rows_;
}

void Session::beginDrag(std::string name) {
  endDrag();
  history.begin(std::move(name));
  dragging_ = true;
}
void Session::endDrag() {
  if (dragging_) history.commit();
  dragging_ = false;
}

Replay Session::undo() {
  Replay replay = history.undo();
  for (const std::string& missing : replay.missing)
    log.warn(missing + " is not there now; it was passed over");
  return replay;
}
Replay Session::redo() {
  Replay replay = history.redo();
  for (const std::string& missing : replay.missing)
    log.warn(missing + " is not there now; it was passed over");
  return replay;
}

// ---- for scripts and the title

bool Session::loaded() const {
  return stage.world().loaded() && !viewing.frame_when_loaded;
}

std::string Session::title() const {
  std::string name = world_file_.empty() ? "untitled" : world_file_.filename().string();
  if (world_file_.empty() && scenes.entries().size() == 1) name = scenes.entries().front().id;
  return fmt::format("{}{} - Lambent", name, modified() ? "*" : "");
}

bool Session::titleChanged() {
  std::string now = title();
  if (now == title_) return false;
  title_ = std::move(now);
  return true;
}

std::string Session::statusLine() const {
  const double ms = stage.times().median();
  std::string text = fmt::format("{:.1f} ms", ms);
  std::size_t working = 0;
  for (const baker::JobState& job : scenes.jobs())
    working += job.phase == baker::JobPhase::Baking || job.phase == baker::JobPhase::Waiting ||
               job.phase == baker::JobPhase::Importing;
  if (working > 0) text = fmt::format("bakes: {}   {}", working, text);
  if (!stage.atRest()) text = "light settles   " + text;
  return text;
}

}  // namespace lambent::editor
