// Owns the textures of the environment maps' thumbnails, which the session reads on the CPU. Main thread,
// with a current OpenGL context.
#pragma once

#include <filesystem>
#include <map>

#include "editor/session/environment_map_shelf.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::editor {

class Thumbnails {
 public:
  // Uploads new thumbnails, tells the shelf their textures, and deletes textures of files that are no longer
  // on the shelf. Call it once a frame.
  void update(EnvironmentMapShelf& shelf);

 private:
  std::map<std::filesystem::path, gpu::Texture> textures_;
};

}  // namespace lambent::editor
