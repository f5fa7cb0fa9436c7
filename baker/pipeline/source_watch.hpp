// Watches scenes on disk: .gltf and .glb files, single ones or all in a folder and its subfolders, with every
// file that they refer to (buffers, images, volumes, BRDFs). It checks sizes and times a few times a second
// on its own thread, which works on any file system. A change is reported once nothing has changed for a
// moment; whether the scene can be read is for its bake to say. Bundles (.lmb.glb) and hidden files are not
// scenes.
//
// All calls are safe from any thread and never throw.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace lambent::baker {

struct WatchSettings {
  std::chrono::milliseconds look_every{200};
  std::chrono::milliseconds still_for{400};  // how long files must be unchanged before a change counts
};

struct WatchEvent {
  enum class Kind : std::uint8_t {
    Found,    // a scene, at the start or new
    Changed,  // the scene, or a file that it refers to, changed
    Removed   // the scene file itself is gone
  };
  Kind kind = Kind::Found;
  std::filesystem::path scene;
};

class SourceWatch {
 public:
  // `sources` are scene files and folders; those that do not exist yet are waited for.
  explicit SourceWatch(std::vector<std::filesystem::path> sources, WatchSettings settings = {});
  ~SourceWatch();
  SourceWatch(const SourceWatch&) = delete;
  SourceWatch& operator=(const SourceWatch&) = delete;

  // Replaces the sources.
  void setSources(std::vector<std::filesystem::path> sources);
  std::vector<WatchEvent> takeEvents();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Returns whether the name is that of a scene to bake: .gltf or .glb, not .lmb.glb, not hidden.
bool isSceneFile(const std::filesystem::path& path);

// Returns the scenes in a folder and its subfolders, without hidden ones, sorted by path.
std::vector<std::filesystem::path> scenesIn(const std::filesystem::path& folder);

// Returns where a scene is baked to if nothing else is said: NAME.lmb.glb in its own folder.
std::filesystem::path bundleBeside(const std::filesystem::path& scene);

}  // namespace lambent::baker
