#include "baker/pipeline/source_watch.hpp"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>

#include "baker/import/check.hpp"
#include "baker/import/scene_files.hpp"

namespace lambent::baker {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void add(const json& uri, const fs::path& folder, std::vector<fs::path>& files) {
  if (!uri.is_string()) return;
  const auto text = uri.get<std::string>();
  if (text.empty() || text.find(':') != std::string::npos) return;  // such as data:, procedural: and http:
  const fs::path file = folder / decodePercent(text);
  if (std::ranges::find(files, file) == files.end()) files.push_back(file);
}

// Returns the files that a scene names, itself first, whether they exist or not. This is best effort, from
// its JSON alone.
std::vector<fs::path> sourceFiles(const fs::path& scene) {
  std::vector<fs::path> files = {scene};
  const auto container = openContainer(scene);
  if (!container) return files;
  const json document = json::parse(container->json, nullptr, /*allow_exceptions=*/false);
  const fs::path folder = scene.parent_path();
  for (const char* list : {"buffers", "images"})
    for (const json& entry : memberOf(document, {list})) add(memberOf(entry, {"uri"}), folder, files);
  for (const json& node : memberOf(document, {"nodes"}))
    add(memberOf(node, {"extras", "lambent", "volume", "file"}), folder, files);
  for (const json& material : memberOf(document, {"materials"}))
    add(memberOf(material, {"extras", "lambent", "brdf"}), folder, files);
  return files;
}

using Clock = std::chrono::steady_clock;

// A Stamp distinguishes one content of a file from another.
struct Stamp {
  bool there = false;
  std::uintmax_t size = 0;
  fs::file_time_type time{};
  bool operator==(const Stamp&) const = default;
};

Stamp stampOf(const fs::path& file) {
  std::error_code failed;
  Stamp stamp;
  stamp.size = fs::file_size(file, failed);
  if (failed) return {};
  stamp.time = fs::last_write_time(file, failed);
  stamp.there = !failed;
  return stamp.there ? stamp : Stamp{};
}

std::vector<Stamp> stampsOf(const std::vector<fs::path>& files) {
  std::vector<Stamp> stamps;
  for (const fs::path& file : files) stamps.push_back(stampOf(file));
  return stamps;
}

struct Watched {
  std::vector<fs::path> files;  // the scene comes first
  std::vector<Stamp> stamps;
  Clock::time_point moved;  // time of their last change
  std::optional<Clock::time_point> missing;
  bool dirty = true, told = false;
};

}  // namespace

bool isSceneFile(const fs::path& path) {
  const std::string name = path.filename().string();
  if (name.empty() || name.front() == '.' || name.ends_with(".lmb.glb")) return false;
  return path.extension() == ".gltf" || path.extension() == ".glb";
}

fs::path bundleBeside(const fs::path& scene) {
  return scene.parent_path() / (scene.stem().string() + ".lmb.glb");
}

namespace {

// Collects the scenes of a folder and its subfolders, without hidden folders.
void collect(const fs::path& folder, std::set<fs::path>& scenes) {
  std::error_code failed;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, failed), end;
  for (; !failed && at != end; at.increment(failed)) {
    std::error_code gone;
    if (at->is_directory(gone)) {
      if (at->path().filename().string().starts_with('.')) at.disable_recursion_pending();
    } else if (isSceneFile(at->path())) {
      scenes.insert(at->path());
    }
  }
}

}  // namespace

struct SourceWatch::Impl {
  WatchSettings settings;
  mutable std::mutex lock;
  std::condition_variable_any changed;
  std::vector<fs::path> sources;
  std::vector<WatchEvent> events;
  std::map<fs::path, Watched> watched;  // used by the thread only
  std::jthread thread;                  // last, so that it stops before the rest is destroyed

  void tell(WatchEvent::Kind kind, const fs::path& scene) {
    const std::lock_guard hold(lock);
    events.push_back({kind, scene});
  }

  void run(const std::stop_token& stop) {
    std::unique_lock hold(lock);
    while (!stop.stop_requested()) {
      const std::vector<fs::path> now = sources;
      hold.unlock();
      look(now, stop);
      hold.lock();
      changed.wait_for(hold, stop, settings.look_every, [&] { return sources != now; });
    }
  }

  void look(const std::vector<fs::path>& from, const std::stop_token& stop);
  bool gone(const fs::path& scene, Watched& state, bool listed);
  void check(const fs::path& scene, Watched& state);
};

void SourceWatch::Impl::look(const std::vector<fs::path>& from, const std::stop_token& stop) {
  std::set<fs::path> scenes;
  for (const fs::path& source : from) {
    std::error_code failed;
    if (fs::is_directory(source, failed))
      collect(source, scenes);
    else if (fs::exists(source, failed))
      scenes.insert(source);
  }
  for (const fs::path& scene : scenes)
    if (const auto [entry, added] = watched.try_emplace(scene); added) {
      entry->second.files = {scene};
      entry->second.moved = Clock::now();
    }
  for (auto at = watched.begin(); at != watched.end() && !stop.stop_requested();) {
    if (gone(at->first, at->second, scenes.contains(at->first))) {
      at = watched.erase(at);
    } else {
      if (!at->second.missing) check(at->first, at->second);
      ++at;
    }
  }
}

// A scene counts as gone only after a while, since programs that replace a file may remove it first.
bool SourceWatch::Impl::gone(const fs::path& scene, Watched& state, bool listed) {
  if (listed) {
    state.missing.reset();
    return false;
  }
  if (!state.missing) state.missing = Clock::now();
  if (Clock::now() - *state.missing < settings.still_for) return false;
  if (state.told) tell(WatchEvent::Kind::Removed, scene);
  return true;
}

void SourceWatch::Impl::check(const fs::path& scene, Watched& state) {
  const Clock::time_point now = Clock::now();
  if (std::vector<Stamp> stamps = stampsOf(state.files); stamps != state.stamps) {
    if (state.stamps.empty() || stamps.front() != state.stamps.front()) {
      state.files = sourceFiles(scene);  // the scene may name other files now
      stamps = stampsOf(state.files);
    }
    state.stamps = std::move(stamps);
    state.moved = now;
    state.dirty = true;
    return;
  }
  if (!state.dirty || now - state.moved < settings.still_for) return;
  state.dirty = false;
  tell(std::exchange(state.told, true) ? WatchEvent::Kind::Changed : WatchEvent::Kind::Found, scene);
}

std::vector<fs::path> scenesIn(const fs::path& folder) {
  std::set<fs::path> scenes;
  collect(folder, scenes);
  return {scenes.begin(), scenes.end()};
}

SourceWatch::SourceWatch(std::vector<fs::path> sources, WatchSettings settings)
    : impl_(std::make_unique<Impl>()) {
  impl_->settings = settings;
  impl_->sources = std::move(sources);
  impl_->thread = std::jthread([impl = impl_.get()](const std::stop_token& stop) { impl->run(stop); });
}

SourceWatch::~SourceWatch() {
  impl_->thread.request_stop();
  impl_->thread.join();
}

void SourceWatch::setSources(std::vector<fs::path> sources) {
  const std::lock_guard hold(impl_->lock);
  impl_->sources = std::move(sources);
  impl_->changed.notify_all();
}

std::vector<WatchEvent> SourceWatch::takeEvents() {
  const std::lock_guard hold(impl_->lock);
  return std::exchange(impl_->events, {});
}

}  // namespace lambent::baker
