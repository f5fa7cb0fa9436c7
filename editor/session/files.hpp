// Opens and saves scenes, bundles, folders of them, and the world file that records how they are placed and
// edited. Knows which world file is open and whether it has unsaved changes. Main thread. Errors name the
// file and change nothing, except that a bundle of a world file that cannot be opened is logged and skipped.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "editor/document/world_file.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

class Session;

class Files {
 public:
  // The session must outlive it.
  explicit Files(Session& session) : session_(session) {}

  // Opens a scene, a bundle, a folder of them, or a world.
  Result<void> open(const std::filesystem::path& path);
  void openLogged(const std::filesystem::path& path);
  // Saves the world to this file, which becomes the world's file.
  Result<void> save(const std::filesystem::path& path);
  // Closes everything and begins an empty world, without asking.
  void closeAll();

  // Returns the world's file, or an empty path if it has none yet.
  const std::filesystem::path& world() const { return world_; }
  // Returns whether closing would lose edits. Scenes that are merely open do not count while the world has no
  // file.
  bool modified() const;
  // Calls `then`. If there are unsaved edits, a dialog asks first.
  void unlessUnsaved(std::string question, std::function<void(Session&)> then);
  // Quits the editor, after the same question.
  void askToQuit();

 private:
  Result<void> openWorld(const std::filesystem::path& path);
  void keepWorldState();

  Session& session_;
  std::filesystem::path world_;
  std::optional<WorldFile> loaded_;  // the file as it was loaded: its unknown parts are saved again
};

}  // namespace lambent::editor
