// Opens and closes scenes as steps of the history. Undoing a close opens the scene's files again and restores
// its edits; undoing an open closes the scene. A reopened scene has the same StableIds, so earlier steps stay
// valid. If it has no bundle yet, its edits are restored when the first one is shown. Main thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "editor/document/overrides.hpp"
#include "editor/session/scenes.hpp"

namespace lambent::editor {

class Session;

// Holds a scene that was closed, or a folder that is no longer watched.
struct ClosedScene {
  SceneEntry entry;
  std::size_t place = 0;  // index among the entries
  Overrides kept;         // edits of its bundle
  std::filesystem::path folder;
};

class SceneSteps {
 public:
  explicit SceneSteps(Session& session) : session_(session) {}

  // Opens everything that belongs to the path as one step. Errors: there is nothing that can be opened.
  Result<void> open(const std::filesystem::path& path);
  void close(std::size_t entry);
  // Keeps those of a world file's edits whose entities do not exist, until their scenes are shown. Returns
  // how many these are.
  std::size_t await(const Overrides& edits);
  // Restores the edits of scenes whose bundle is now shown. Call it once a frame.
  void update();
  void clear() { waiting_.clear(), awaited_.clear(); }

  // The rest is for the steps themselves. bring() opens the scene again.
  Result<void> bring(const ClosedScene& scene);
  // Closes the scene and stores its state in `scene`. Returns false if it is not open.
  bool take(ClosedScene& scene);

 private:
  struct Waiting {
    SceneEntry entry;
    Overrides kept;
  };

  Session& session_;
  void restoreAwaited();

  std::vector<Waiting> waiting_;
  Overrides awaited_;
};

}  // namespace lambent::editor
