// Lists environment maps to choose from: the .hdr and .exr files in the folders of those in use, of the open
// scenes, and in folders that were added, each with a thumbnail. Files are read one at a time on another
// thread. Main thread. A file that cannot be read stays in the list with its error.
#pragma once

#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "editor/session/scenes.hpp"
#include "runtime/base/change_gate.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::editor {

class EnvironmentMapShelf {
 public:
  struct EnvironmentMap {
    std::filesystem::path file;
    spec::Rgba8Image thumbnail;  // empty: not loaded yet
    std::string error;
    std::uint32_t texture = 0;  // OpenGL name of the thumbnail's texture; 0: none yet
  };

  void addFolder(const std::filesystem::path& folder);
  // Lists the files again if the folders may have changed, and loads one thumbnail at a time.
  void update(const std::vector<std::string>& light_words, const Scenes& scenes);
  // Returns whether a thumbnail is being loaded.
  bool busy() const;
  const std::vector<EnvironmentMap>& environment_maps() const { return environment_maps_; }
  std::vector<EnvironmentMap>& environment_maps() { return environment_maps_; }

 private:
  struct Thumbnail {
    spec::Rgba8Image image{};
    std::string error{};
  };
  static Thumbnail read(const std::filesystem::path& file);
  void look();

  // Tells when the folders must be found again: it compares the light words, the version of the scenes and
  // the number of added folders.
  ChangeGate<std::vector<std::string>, std::uint64_t, std::size_t> changed_;
  std::vector<std::filesystem::path> added_, folders_;
  std::vector<EnvironmentMap> environment_maps_;
  std::future<Thumbnail> coming_;
  std::size_t coming_for_ = 0;
};

}  // namespace lambent::editor
