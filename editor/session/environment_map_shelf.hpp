// Lists environment maps to choose from: the .hdr and .exr files in the folders of those in use, of the open
// scenes, and in folders that were added. Main thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "editor/session/assets.hpp"
#include "editor/session/scenes.hpp"
#include "runtime/base/change_gate.hpp"

namespace lambent::editor {

class EnvironmentMapShelf {
 public:
  void addFolder(const std::filesystem::path& folder);
  // Lists the files again if the folders may have changed.
  void update(const std::vector<std::string>& light_words, const Scenes& scenes);
  const std::vector<Asset>& environment_maps() const { return environment_maps_; }

 private:
  // Tells when the folders must be found again: it compares the light words, the version of the scenes and
  // the number of added folders.
  ChangeGate<std::vector<std::string>, std::uint64_t, std::size_t> changed_;
  std::vector<std::filesystem::path> added_, folders_;
  std::vector<Asset> environment_maps_;
};

}  // namespace lambent::editor
