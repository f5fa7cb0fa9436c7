// Watches scenes on disk: .gltf and .glb files, one by one or all in a folder and below, with every file that
// they refer to (buffers, images, volumes, BRDFs). Looks at sizes and times a few times a second on a thread
// of its own, which works on any file system. A change counts once nothing has moved for a moment and the
// whole scene imports; until then the old state stays, and what is wrong is told only if it stays wrong.
// Bundles
// (.lmb.glb) and hidden files are not scenes.
//
// All calls are safe from any thread; none throws.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "baker/import/import_options.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

struct WatchSettings {
  std::chrono::milliseconds look_every{200};
  std::chrono::milliseconds still_for{400};  // that a change must have been
  std::chrono::milliseconds complain_after{3000};
  ImportOptions import;
};

struct WatchEvent {
  enum class Kind : std::uint8_t {
    Found,    // a scene that imports, at the start or new
    Changed,  // it or a file that it refers to; it imports
    Broken,   // it does not import, and has not for a while: `error`
    Removed   // the scene file itself is gone
  };
  Kind kind = Kind::Found;
  std::filesystem::path scene;
  std::optional<Error> error;
};

class SourceWatch {
 public:
  // Scene files and folders. What is not there yet is waited for.
  SourceWatch(std::vector<std::filesystem::path> sources, WatchSettings settings);
  explicit SourceWatch(std::vector<std::filesystem::path> sources);
  ~SourceWatch();
  SourceWatch(const SourceWatch&) = delete;
  SourceWatch& operator=(const SourceWatch&) = delete;

  // In place of those before.
  void setSources(std::vector<std::filesystem::path> sources);
  std::vector<WatchEvent> takeEvents();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The files that a scene names, itself first: best effort, from its JSON alone, whether they exist or not.
std::vector<std::filesystem::path> sourceFiles(const std::filesystem::path& scene);

// Whether the name is that of a scene to bake: .gltf or .glb, not .lmb.glb, not hidden.
bool isSceneFile(const std::filesystem::path& path);

}  // namespace lambent::baker
