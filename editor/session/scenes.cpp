#include "editor/session/scenes.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "baker/bake/bake.hpp"
#include "baker/bake/options.hpp"

namespace lambent::editor {

namespace {

constexpr const char* kBundleEnd = ".lmb.glb";
constexpr const char* kEditsOption = "edits";  // the key in world files

bool isBundle(const std::filesystem::path& path) {
  return path.filename().string().ends_with(kBundleEnd);
}

bool writable(const std::filesystem::path& folder) {
  std::error_code ignored;
  const auto rights = std::filesystem::status(folder, ignored).permissions();
  using std::filesystem::perms;
  return !ignored &&
         (rights & (perms::owner_write | perms::group_write | perms::others_write)) != perms::none;
}

std::vector<std::filesystem::path> filesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (entry.is_regular_file(ignored) && (isBundle(entry.path()) || baker::isSceneFile(entry.path())))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

Scenes::Scenes(frame::World& world, Log& log, SceneSettings settings)
    : world_(world), log_(log), settings_(std::move(settings)) {
  if (settings_.cache_folder.empty()) settings_.cache_folder = baker::Cache::defaultFolder();
  if (!settings_.cache_folder.empty()) {
    auto cache = baker::Cache::open(settings_.cache_folder, settings_.cache_bytes);
    if (cache)
      cache_ = std::move(*cache);
    else
      log_.warn(cache.error().line() + "; bakes keep nothing");
  }
  queue_ = std::make_unique<baker::BakeQueue>(
      baker::QueueSettings{.work_folder = settings_.cache_folder, .cache = cache_ ? &*cache_ : nullptr});
}

Scenes::~Scenes() {
  watch_.reset();
  queue_.reset();  // before the cache that it writes to
}

SceneEntry* Scenes::find(const std::filesystem::path& source) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const SceneEntry& entry) {
    return (!entry.source.empty() && entry.source == source) || entry.bundle == source;
  });
  return found == entries_.end() ? nullptr : &*found;
}

std::optional<baker::JobState> Scenes::jobOf(std::size_t entry) const {
  if (!entries_[entry].job) return std::nullopt;
  for (const baker::JobState& state : jobs_)
    if (state.id == *entries_[entry].job) return state;
  return std::nullopt;
}

// Returns the file's name without its suffix, with a number if another bundle has that id.
std::string Scenes::idFor(const std::filesystem::path& bundle) const {
  std::string stem = bundle.filename().string();
  if (stem.ends_with(kBundleEnd)) stem.resize(stem.size() - std::string_view(kBundleEnd).size());
  std::string id = stem;
  const auto taken = [&] {
    return std::any_of(entries_.begin(), entries_.end(), [&](const SceneEntry& e) { return e.id == id; });
  };
  for (int count = 2; taken(); ++count) id = fmt::format("{}-{}", stem, count);
  return id;
}

std::filesystem::path Scenes::bundleFor(const std::filesystem::path& scene) const {
  std::filesystem::path folder = settings_.output_folder;
  if (folder.empty()) folder = scene.parent_path();
  if (!writable(folder) && !settings_.cache_folder.empty()) folder = settings_.cache_folder / "bundles";
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  return folder / (scene.stem().string() + kBundleEnd);
}

Result<void> Scenes::open(const std::filesystem::path& path) {
  const std::filesystem::path place = baker::plainPath(path);
  std::error_code ignored;
  if (std::filesystem::is_directory(place, ignored)) return openFolder(place);
  if (!std::filesystem::exists(place, ignored))
    return fail(path.string(), "is not there", "check the name, or drop the file onto the window");
  if (find(place)) return fail(path.string(), "is open already", "close it first to open it anew");
  if (isBundle(place)) return openBundle({.bundle = place, .id = idFor(place), .options = settings_.options});
  if (!baker::isSceneFile(place))
    return fail(path.string(), "is no scene, bundle or folder",
                "open .gltf, .glb, .lmb.glb or a folder of them");
  const std::filesystem::path bundle = bundleFor(place);
  openScene({.source = place, .bundle = bundle, .id = idFor(bundle), .options = settings_.options});
  return {};
}

void Scenes::open(const BundleEntry& saved, const std::filesystem::path& folder) {
  SceneEntry entry{.bundle = baker::plainPath(folder / saved.path),
                   .id = saved.id,
                   .instance = saved.instance,
                   .options = optionsOf(saved)};
  std::error_code ignored;
  if (!saved.source.empty()) {
    entry.source = baker::plainPath(folder / saved.source);
    if (const auto edits = saved.bake_options.find(kEditsOption); edits != saved.bake_options.end()) {
      if (auto read = baker::readEdits(edits->second))
        entry.edits = entry.shown_edits = std::move(*read);
      else
        log_.warn(entry.id +
                  ": the world file's edits cannot be read; the scene is baked as its own file says, and the "
                  "next save of the world drops them");
    }
    if (std::filesystem::exists(entry.source, ignored)) {
      entry.bundle = bundleFor(entry.source);
      return openScene(std::move(entry));
    }
  }
  if (const auto opened = openBundle(entry); !opened) {
    entry.missing = opened.error();
    if (!std::filesystem::exists(entry.bundle, ignored))
      entry.missing = Error{entry.bundle.string(), "is not there",
                            entry.source.empty() ? "put it back and open the world again, or close it here"
                                                 : "put back its scene " + entry.source.string() +
                                                       ", which is then baked, or close it here"};
    log_.error(*entry.missing);
    entries_.push_back(std::move(entry));
    ++version_;
  }
  watch();
}

Result<void> Scenes::openBundle(SceneEntry entry) {
  const auto slot = world_.open(entry.bundle, {.bundle_id = entry.id, .instance = entry.instance});
  if (!slot) return failAgain(slot.error());
  entry.slot = *slot, entry.shown = entry.bundle;
  entries_.push_back(std::move(entry));
  ++version_;
  return {};
}

// Returns the options that the world was saved with; threads and memory are this machine's. Options of
// another version cannot be read: this is logged, and the defaults are used.
baker::BakeOptions Scenes::optionsOf(const BundleEntry& entry) {
  std::map<std::string, std::string> words = entry.bake_options;
  words.erase(kEditsOption);
  if (words.empty()) return settings_.options;
  auto options = baker::BakeOptions::fromSettings(words);
  if (!options) {
    log_.warn(entry.id +
              ": the world file's bake_options are not those of this version; the usual ones are taken");
    return settings_.options;
  }
  options->threads = settings_.options.threads;
  options->memory_bytes = settings_.options.memory_bytes;
  return *options;
}

void Scenes::openScene(SceneEntry entry) {
  std::error_code ignored;
  // A bundle that exists is shown meanwhile, even if it is out of date.
  if (std::filesystem::exists(entry.bundle, ignored)) {
    if (const auto slot = world_.open(entry.bundle, {.bundle_id = entry.id, .instance = entry.instance}))
      entry.slot = *slot, entry.shown = entry.bundle;
  }
  entries_.push_back(std::move(entry));
  ++version_;
  request(entries_.back());
  watch();
}

Result<void> Scenes::openFolder(const std::filesystem::path& folder) {
  const auto files = filesIn(folder);
  if (files.empty()) log_.note(folder.string() + ": no scenes yet; what comes is opened");
  for (const std::filesystem::path& file : files) {
    if (find(file)) continue;
    // The bundle of a scene in this folder is opened with the scene.
    const bool of_scene = isBundle(file) && std::any_of(files.begin(), files.end(), [&](const auto& other) {
                            return baker::isSceneFile(other) && bundleFor(other) == file;
                          });
    if (of_scene) continue;
    if (auto opened = open(file); !opened) log_.error(opened.error());
  }
  if (std::ranges::find(watched_, folder) == watched_.end()) watched_.push_back(folder);
  watch();
  return {};
}

void Scenes::request(SceneEntry& entry, baker::PreviewLevel last) {
  entry.missing.reset();
  entry.job = queue_->add({.scene = entry.source,
                           .output = entry.bundle,
                           .options = entry.options,
                           .edits = entry.edits,
                           .last = last});
  jobs_ = queue_->states();
}

void Scenes::watch() {
  std::vector<std::filesystem::path> sources = watched_;
  for (const SceneEntry& entry : entries_)
    if (!entry.source.empty()) sources.push_back(entry.source);
  if (watch_)
    watch_->setSources(std::move(sources));
  else
    watch_ = std::make_unique<baker::SourceWatch>(std::move(sources));
}

void Scenes::show(SceneEntry& entry, const std::filesystem::path& bundle) {
  entry.shown = bundle;
  ++version_;
  if (entry.slot) {
    if (auto replaced = world_.replace(*entry.slot, bundle); !replaced) log_.error(replaced.error());
    return;
  }
  const auto slot = world_.open(bundle, {.bundle_id = entry.id, .instance = entry.instance});
  if (slot)
    entry.slot = *slot;
  else
    log_.error(slot.error());
}

void Scenes::take(const baker::BakeEvent& event) {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const SceneEntry& entry) { return entry.job == event.job; });
  if (found == entries_.end()) return;
  using Kind = baker::BakeEvent::Kind;
  const auto job = jobOf(static_cast<std::size_t>(found - entries_.begin()));
  if (event.kind == Kind::Failed && job && job->error) log_.error(*job->error);
  if (event.kind == Kind::Cancelled) log_.note(found->source.filename().string() + ": bake cancelled");
  if (event.kind != Kind::Bundle) return;
  if (job && event.preview_level == baker::PreviewLevel::Final)
    for (const std::string& warning : job->warnings)
      log_.warn(found->source.filename().string() + ": " + warning);
  // An unshadowed preview does not replace a final bundle.
  if (event.preview_level == baker::PreviewLevel::Unshadowed && found->slot && found->shown == found->bundle)
    return;
  if (job) found->shown_edits = job->request.edits;
  show(*found, event.bundle);
  if (event.preview_level == baker::PreviewLevel::Final && job && !job->up_to_date)
    log_.note(fmt::format("{}: baked in {:.{}f} s", found->bundle.filename().string(), job->seconds,
                          job->seconds < 9.95 ? 1 : 0));
}

// Returns whether a watched folder contains the scene.
bool Scenes::isWatched(const std::filesystem::path& scene) const {
  return std::any_of(watched_.begin(), watched_.end(), [&](const std::filesystem::path& folder) {
    const std::filesystem::path way = scene.lexically_relative(folder);
    return !way.empty() && *way.begin() != "..";
  });
}

void Scenes::take(const baker::WatchEvent& event) {
  using Kind = baker::WatchEvent::Kind;
  const std::filesystem::path scene = baker::plainPath(event.scene);
  SceneEntry* entry = find(scene);
  if (event.kind == Kind::Removed && entry) {
    log_.warn(scene.string() + ": is gone; its bundle stays");
  } else if (event.kind == Kind::Found && !entry && isWatched(scene)) {
    if (auto opened = open(scene); !opened) log_.error(opened.error());
  } else if (event.kind == Kind::Found && entry && entry->missing) {
    log_.note(scene.filename().string() + ": is back");
    request(*entry);
  } else if (event.kind == Kind::Changed && entry) {
    log_.note(scene.filename().string() + ": has changed");
    request(*entry);
  }
}

bool Scenes::update() {
  const std::uint64_t before = version_;
  idle_updates_ = queue_->busy() ? 0 : idle_updates_ + 1;
  // The states are asked for after the events, so that they are no older than what the events tell.
  const std::vector<baker::BakeEvent> events = queue_->takeEvents();
  jobs_ = queue_->states();
  for (const baker::BakeEvent& event : events) take(event);
  if (watch_)
    for (const baker::WatchEvent& event : watch_->takeEvents()) take(event);
  return version_ != before;
}

Result<void> Scenes::bake(std::size_t index, baker::SceneEdits edits) {
  SceneEntry& entry = entries_[index];
  if (entry.source.empty())
    return fail(entry.bundle.string(), "has no scene to be baked from", "open its .gltf or .glb file");
  std::error_code ignored;
  if (!std::filesystem::exists(entry.source, ignored))
    return fail(entry.source.string(), "is not there", "put it back, or close the scene");
  entry.edits = std::move(edits);
  request(entry, baker::PreviewLevel::Final);
  return {};
}

void Scenes::cancel(std::size_t entry) {
  if (!entries_[entry].job) return;
  queue_->cancel(*entries_[entry].job);
  jobs_ = queue_->states();
}

bool Scenes::busy() const {
  return queue_->busy() || idle_updates_ < 2;
}

void Scenes::close(std::size_t index) {
  cancel(index);
  if (entries_[index].slot) world_.close(*entries_[index].slot);
  entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(index));
  ++version_;
  watch();
}

void Scenes::closeAll() {
  watched_.clear();
  while (!entries_.empty()) close(entries_.size() - 1);
}

std::vector<BundleEntry> Scenes::state(const std::filesystem::path& folder) const {
  const auto relative = [&](const std::filesystem::path& path) {
    const std::filesystem::path way = path.lexically_relative(baker::plainPath(folder));
    return (way.empty() ? path : way).generic_string();
  };
  std::vector<BundleEntry> bundles;
  for (const SceneEntry& entry : entries_) {
    BundleEntry& bundle = bundles.emplace_back();
    bundle.path = relative(entry.bundle);
    bundle.id = entry.id;
    bundle.instance = entry.instance;
    if (!entry.source.empty()) bundle.source = relative(entry.source);
    bundle.bake_options = entry.options.settings();
    if (!entry.edits.empty()) bundle.bake_options[kEditsOption] = baker::editsText(entry.edits);
  }
  return bundles;
}

Result<void> Scenes::setOption(std::size_t index, std::string_view name, std::string_view word) {
  SceneEntry& entry = entries_[index];
  baker::BakeOptions options = entry.options;
  if (auto done = baker::putOption(options, name, word); !done) return done;
  if (auto checked = baker::checkRequest(options, entry.bundle); !checked) return checked;
  entry.options = options;
  return {};
}

}  // namespace lambent::editor
