// Opens and saves the files of the world: scenes, bundles, folders of them, and the world file that says how
// they stand and what was edited. Knows the world file that is open, and whether it would lose anything.
// Main thread. Errors name the file and change nothing; what is wrong with a single bundle of a world file is
// logged, and the others are opened.
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
  // The session outlives it.
  explicit Files(Session& session) : session_(session) {}

  // Opens a scene, a bundle, a folder of them, or a world.
  Result<void> open(const std::filesystem::path& path);
  void openLogged(const std::filesystem::path& path);
  // Saves the world to this file, which is the world's file from then on.
  Result<void> save(const std::filesystem::path& path);
  // Closes everything and begins an empty world, without asking.
  void closeAll();

  // Returns the world's file; empty: it has none yet.
  const std::filesystem::path& world() const { return world_; }
  // Returns whether something would be lost. What is merely open in a world that has no file would not.
  bool modified() const;
  // Calls `then`, after a dialog has asked whether edits may be lost if there are any.
  void unlessUnsaved(std::string question, std::function<void(Session&)> then);
  // Makes the editor quit, after the same question.
  void askToQuit();

 private:
  Result<void> openWorld(const std::filesystem::path& path);
  void keepWorldState();

  Session& session_;
  std::filesystem::path world_;
  std::optional<WorldFile> loaded_;  // parts of it that this version does not know are saved again
};

}  // namespace lambent::editor
