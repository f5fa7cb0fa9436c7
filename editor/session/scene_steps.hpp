// Opens and closes scenes as steps of the history. A scene that is closed leaves behind what was edited of
// it, and undo brings it back from its files with these edits; what was opened is closed by undo. History
// speaks by StableIds, which are the same when a scene comes back, so earlier steps go on working. Edits of a
// scene of which no bundle is there yet are put back when its first one comes. Main thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "editor/document/overrides.hpp"
#include "editor/session/scenes.hpp"

namespace lambent::editor {

class Session;

// Holds a scene that is not in the world now, or a folder that is not watched.
struct ClosedScene {
  SceneEntry entry;
  std::size_t place = 0;  // among the entries
  Overrides kept;         // what differed from its bundle
  std::filesystem::path folder;
};

class SceneSteps {
 public:
  explicit SceneSteps(Session& session) : session_(session) {}

  // Opens as one step all that comes with the path. Errors: nothing there that can be opened.
  Result<void> open(const std::filesystem::path& path);
  void close(std::size_t entry);
  // Puts back edits of scenes whose bundle has come; call it once a frame.
  void update();
  void clear() { waiting_.clear(); }

  // The rest is for the steps themselves. Brings the scene back.
  Result<void> bring(const ClosedScene& scene);
  // Takes the scene out of the world and keeps it as it was. Returns false where it is not there.
  bool take(ClosedScene& scene);

 private:
  struct Waiting {
    std::string id;
    Overrides kept;
  };

  Session& session_;
  std::vector<Waiting> waiting_;
};

}  // namespace lambent::editor
