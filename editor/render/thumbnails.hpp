// Owns textures of the small pictures that the session reads on the CPU: thumbnails of environment maps. Main
// thread, with a current OpenGL context.
#pragma once

#include <filesystem>
#include <map>

#include "editor/session/environment_map_shelf.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::editor {

class Thumbnails {
 public:
  // Brings thumbnails that are new onto the GPU, tells the shelf their textures, and drops those of files
  // that are not on the shelf any more. Call it once a frame.
  void update(EnvironmentMapShelf& shelf);

 private:
  std::map<std::filesystem::path, gpu::Texture> textures_;
};

}  // namespace lambent::editor
