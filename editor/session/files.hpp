// Opens and saves scenes, bundles, folders of them, and the world file that records how they are placed and
// edited. Knows which world file is open and whether it has unsaved changes. Main thread. Errors name the
// file and change nothing, except that a bundle of a world file that cannot be opened is logged and skipped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "editor/document/overrides.hpp"
#include "editor/document/world_file.hpp"
#include "editor/session/scenes.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

class Session;

class Files {
 public:
  // The session must outlive it.
  explicit Files(Session& session) : session_(session) {}

  // Opens scenes, bundles, folders of them, or a world, which takes the place of everything. If that would
  // lose edits, a dialog asks first, and all is opened after its answer. Errors: those of the first that
  // cannot be opened; the rest is not opened then.
  Result<void> open(const std::vector<std::filesystem::path>& paths);
  // The same, but each error is logged, and the rest is opened.
  void openLogged(const std::vector<std::filesystem::path>& paths);
  Result<void> save(const std::filesystem::path& path);
  // Saves what closing would lose under a name of its own, beside the world's file or, if it has none, in the
  // working folder. Returns where it lies, or an empty path if nothing would be lost.
  Result<std::filesystem::path> rescue();
  // Takes a scene out of the world. If that would lose edits, a dialog asks first.
  void close(std::size_t entry);
  void closeAll();
  // Restores those edits of a world file that wait for their scene and whose entities have come. Call it when
  // the scenes have changed.
  void restoreAwaited();

  // Returns the world's file, or an empty path if it has none yet.
  const std::filesystem::path& world() const { return world_; }
  // Returns whether closing would lose edits. Scenes that are merely open do not count while the world has no
  // file.
  bool modified() const;
  // Calls `then`. If there are unsaved edits, a dialog asks first, and offers to save them.
  void unlessUnsaved(std::string question, std::function<void(Session&)> then);
  void askToQuit();

 private:
  // Asks before a world takes the place of unsaved edits, and opens the paths after the answer. Returns
  // whether it asks.
  bool asksToOpen(const std::vector<std::filesystem::path>& paths);
  void openAll(const std::vector<std::filesystem::path>& paths);
  Result<void> openNow(const std::filesystem::path& path);
  void openWorld(const std::filesystem::path& path, WorldFile file);
  void keepWorldState();

  Session& session_;
  std::filesystem::path world_;
  std::vector<BundleEntry> bundles_;  // of the world's file
  Overrides awaited_;                 // edits of the world's file whose entities do not exist yet
};

// Returns the folder in which dialogs begin: that of the world, of the scene that is open, or of what was
// opened last.
std::filesystem::path startFolder(const Session& session);
// Opens a dialog that asks for the world's file, saves it there, and then calls `then` if there is one.
// Nothing is called if the dialog is cancelled or the world cannot be saved, which is logged.
void askWhereToSave(Session& session, std::function<void(Session&)> then = {});

}  // namespace lambent::editor
