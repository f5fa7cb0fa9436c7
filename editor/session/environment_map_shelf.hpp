// Environment maps to choose from: the .hdr and .exr files beside those in use, beside the open scenes and in
// folders that were added, each with a small picture of it. Reading happens on a thread beside the editor's.
// Main thread, with a current OpenGL context.
#pragma once

#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "editor/session/scenes.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::editor {

class EnvironmentMapShelf {
 public:
  struct EnvironmentMap {
    std::filesystem::path file;
    gpu::Texture thumbnail;  // no handle: not here yet
    std::string error;
  };

  void addFolder(const std::filesystem::path& folder);
  // Looks again where something has changed; brings one thumbnail at a time.
  void update(const std::vector<std::string>& light_words, const Scenes& scenes);
  const std::vector<EnvironmentMap>& environment_maps() const { return environment_maps_; }

 private:
  struct Thumbnail {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba{};
    std::string error{};
  };
  static Thumbnail read(const std::filesystem::path& file);
  void look();

  // What folders_ were found from.
  std::vector<std::string> words_seen_;
  std::uint64_t scenes_seen_ = 0;
  std::size_t added_seen_ = 0;
  std::vector<std::filesystem::path> added_, folders_;
  std::vector<EnvironmentMap> environment_maps_;
  std::future<Thumbnail> coming_;
  std::size_t coming_for_ = 0;
};

}  // namespace lambent::editor
