// Lists the assets to choose from: those of the folder in use, which is that of what was opened last, and the
// samples that came with the program. Folders are read on another thread. It also holds what the Assets panel
// remembers. Main thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <string>
#include <string_view>
#include <vector>

#include "editor/session/assets.hpp"
#include "runtime/base/change_gate.hpp"
#include "runtime/base/process.hpp"

namespace lambent::editor {

class Session;

struct AssetGroup {
  std::string title;
  std::vector<std::filesystem::path> folders;
  std::vector<Asset> assets;
};

class AssetBrowser {
 public:
  // Takes what was read, and reads the folders again if they or the open scenes have changed. Panels call it
  // in each frame in which they show assets.
  void update(const Session& session);
  // The same, but the list is complete when it returns.
  void updateNow(const Session& session);
  // Returns whether folders are being read.
  bool busy() const;

  const std::vector<AssetGroup>& groups() const { return groups_; }
  // Returns the group of the samples, or null if there are none or they have not been read.
  const AssetGroup* samples() const;
  // Returns the asset with this path or file name, or null if none is listed.
  const Asset* find(std::string_view name) const;

  std::string search;
  std::filesystem::path selected;
  bool large = false;  // large pictures

 private:
  void take();

  std::vector<std::filesystem::path> samples_ = sampleFolders();
  std::vector<AssetGroup> groups_;
  // Tells when folders must be read again: it compares them, their times, and the version of the scenes.
  ChangeGate<std::vector<std::filesystem::path>, std::vector<std::filesystem::file_time_type>, std::uint64_t>
      changed_;
  std::future<std::vector<AssetGroup>> coming_;
};

}  // namespace lambent::editor
