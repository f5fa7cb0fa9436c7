// Owns the scenes and bundles of the world: what was opened, what is being baked, and where it is shown. A
// queue bakes scenes (.gltf, .glb) on its own threads; a scene is shown from its first complete preview on,
// and each better one replaces it. Source files are watched: a changed file is baked again, and the old
// bundle stays until then. Main thread; call update() once a frame.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "baker/cache/cache.hpp"
#include "baker/import/scene_edits.hpp"
#include "baker/pipeline/bake_queue.hpp"
#include "baker/pipeline/source_watch.hpp"
#include "editor/document/document.hpp"
#include "editor/session/log.hpp"
#include "runtime/world/world.hpp"

namespace lambent::editor {

struct SceneEntry {
  std::filesystem::path source{};       // the glTF file; empty: only a bundle
  std::filesystem::path bundle{};       // path of the final bundle, which may not exist yet
  std::string id{};                     // its part of StableIds and world files
  std::uint32_t instance = 0;           // tells apart entries of one id
  std::optional<std::uint32_t> slot{};  // its slot in frame::World
  std::filesystem::path shown{};        // the bundle that is in that slot or being loaded into it
  std::optional<baker::JobId> job{};
  baker::BakeOptions options{};
  baker::SceneEdits edits{};        // the edits that the last bake was asked for
  baker::SceneEdits shown_edits{};  // the edits that the shown bundle was baked with
  // Why the bundle cannot be opened and its scene is not there. The scene waits until it is back.
  std::optional<Error> missing{};

  bool isSame(const SceneEntry& other) const { return id == other.id && instance == other.instance; }
};

struct SceneSettings {
  std::filesystem::path output_folder;  // for bundles; empty: beside their scenes
  std::filesystem::path cache_folder;   // empty: the default folder
  std::uint64_t cache_bytes = baker::kCacheBytes;
  bool bake = true;  // bake scenes when they are opened; false: only make the first, unshadowed preview
  baker::BakeOptions options;
};

class Scenes {
 public:
  Scenes(frame::World& world, Log& log, SceneSettings settings);
  ~Scenes();

  // Opens a scene, a bundle, or a folder of them, which is then watched. Errors: there is nothing that can be
  // opened.
  Result<void> open(const std::filesystem::path& path);
  // Opens a bundle of a world file, or its scene, under the id in that file. If neither is there, the entry
  // is kept with its error, so that the rest of the world is shown and saved with it.
  void open(const BundleEntry& entry, const std::filesystem::path& folder);
  void close(std::size_t entry);
  void closeAll();
  // Applies what bakes and file changes did since the last call. Returns whether anything changed.
  bool update();

  // Bakes the entry with these edits. Errors: the entry is a bundle without a source, or it is not there.
  Result<void> bake(std::size_t entry, baker::SceneEdits edits);
  Result<void> setOption(std::size_t entry, std::string_view name, std::string_view word);
  void cancel(std::size_t entry);
  // Returns whether bakes are running or have results that update() has not applied yet.
  bool busy() const;

  const std::vector<SceneEntry>& entries() const { return entries_; }
  // Returns the state at the last update() or request, so that all parts of a frame say the same.
  std::optional<baker::JobState> jobOf(std::size_t entry) const;
  // Returns the entries for a world file, with paths relative to `folder`.
  std::vector<BundleEntry> state(const std::filesystem::path& folder) const;
  // Increases when an entry is added or removed, or shows another bundle.
  std::uint64_t version() const { return version_; }

 private:
  baker::BakeOptions optionsOf(const BundleEntry& entry);
  void openScene(SceneEntry entry);
  Result<void> openBundle(SceneEntry entry);
  Result<void> openFolder(const std::filesystem::path& folder);
  void show(SceneEntry& entry, const std::filesystem::path& bundle);
  void take(const baker::BakeEvent& event);
  void take(const baker::WatchEvent& event);
  void watch();
  bool isWatched(const std::filesystem::path& scene) const;
  void request(SceneEntry& entry, baker::PreviewLevel last);
  void request(SceneEntry& entry) {
    request(entry, settings_.bake ? baker::PreviewLevel::Final : baker::PreviewLevel::Unshadowed);
  }
  std::string idFor(const std::filesystem::path& bundle) const;
  std::filesystem::path bundleFor(const std::filesystem::path& scene) const;
  SceneEntry* find(const std::filesystem::path& source);

  frame::World& world_;
  Log& log_;
  SceneSettings settings_;
  std::optional<baker::Cache> cache_;
  std::unique_ptr<baker::BakeQueue> queue_;
  std::unique_ptr<baker::SourceWatch> watch_;
  std::vector<std::filesystem::path> watched_;  // folders
  std::vector<SceneEntry> entries_;
  std::vector<baker::JobState> jobs_;  // as update() or a request found them
  std::uint64_t version_ = 1;
  std::uint64_t idle_updates_ = 0;  // consecutive calls of update() with nothing to bake
};

}  // namespace lambent::editor
