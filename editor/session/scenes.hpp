// Owns the scenes and bundles of the world: what was opened, what is baked of it, and where it is shown. A
// scene (.gltf, .glb) is baked by a queue on threads of its own and shown as soon as its first preview is
// whole; each better one takes the place of the one before. Sources are watched: a file that changes is baked
// again, and the old state stays until then. Main thread; update() once a frame brings over what happened
// elsewhere.
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
#include "editor/document/world_state.hpp"
#include "editor/session/log.hpp"
#include "runtime/world/world.hpp"

namespace lambent::editor {

struct SceneEntry {
  std::filesystem::path source{};       // the glTF file; empty: a bundle alone
  std::filesystem::path bundle{};       // where the final bundle is, or will be
  std::string id{};                     // of StableIds and world files
  std::optional<std::uint32_t> slot{};  // in the world
  std::filesystem::path shown{};        // the bundle that is in that slot, or on its way there
  std::optional<baker::JobId> job{};
  baker::BakeOptions options{};
  baker::SceneEdits edits{};        // of the world, that its bundle was last asked to be baked with
  baker::SceneEdits shown_edits{};  // that what is shown was baked with
};

struct SceneSettings {
  std::filesystem::path output_folder;  // of bundles; empty: beside their scenes
  std::filesystem::path cache_folder;   // empty: the usual one
  std::uint64_t cache_bytes = baker::kCacheBytes;
  bool bake = true;  // scenes at once when they are opened; else only their first, unshadowed preview
  baker::BakeOptions options;
};

class Scenes {
 public:
  Scenes(frame::World& world, Log& log, SceneSettings settings);
  ~Scenes();

  // Opens a scene, a bundle, or a folder of them, which is watched then. Errors: nothing there that can be
  // opened.
  Result<void> open(const std::filesystem::path& path);
  // Opens a bundle, or its scene, as a world file has it, under the id that it has there.
  Result<void> open(const BundleEntry& entry, const std::filesystem::path& folder);
  void close(std::size_t entry);
  void closeAll();
  // Opens what was closed, at its place again: what is on disk is shown, and baked with what it was baked
  // with. Errors: neither its bundle nor its scene is there any more.
  Result<void> reopen(SceneEntry entry, std::size_t place);
  void watchFolder(const std::filesystem::path& folder);
  void unwatchFolder(const std::filesystem::path& folder);

  // Takes over what bakes and files did since the last call. Returns whether anything changed.
  bool update();

  // Bakes it with the edits that the world makes to it; a bundle without a source is an error.
  Result<void> bake(std::size_t entry, baker::SceneEdits edits);
  Result<void> setOption(std::size_t entry, std::string_view name, std::string_view word);
  void cancel(std::size_t entry);
  // Returns true until what was baked has been brought over, too.
  bool busy() const;
  // Opens the scenes of bakes that an earlier session left unfinished, and returns how many there were.
  std::size_t resume();

  const std::vector<SceneEntry>& entries() const { return entries_; }
  std::vector<baker::JobState> jobs() const { return queue_->states(); }
  std::optional<baker::JobState> jobOf(std::size_t entry) const;
  std::optional<std::size_t> entryOf(std::uint32_t slot) const;
  const std::vector<std::filesystem::path>& watched() const { return watched_; }
  // Returns the entries as a world file is to have them, with paths relative to `folder`.
  std::vector<BundleEntry> state(const std::filesystem::path& folder) const;
  // Rises when entries come, go, or show another bundle.
  std::uint64_t version() const { return version_; }

 private:
  baker::BakeOptions optionsOf(const BundleEntry& entry);
  Result<void> openScene(const std::filesystem::path& scene, std::string id,
                         const baker::BakeOptions& options, baker::SceneEdits edits);
  Result<void> openBundle(const std::filesystem::path& bundle, std::string id);
  Result<void> openFolder(const std::filesystem::path& folder);
  void show(SceneEntry& entry, const std::filesystem::path& bundle);
  void take(const baker::BakeEvent& event);
  void take(const baker::WatchEvent& event);
  void watch();
  bool isWatched(const std::filesystem::path& scene) const;
  void request(SceneEntry& entry);
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
  std::uint64_t version_ = 1;
  std::uint64_t idle_updates_ = 0;  // in a row, with nothing to bake
};

}  // namespace lambent::editor
