// Makes the pictures of the materials that panels ask for: a sphere of each, drawn anew when the material
// changes, and its textures as they are on the GPU. Main thread, with a current OpenGL context.
#pragma once

#include <map>

#include "editor/session/session.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::editor {

class MaterialPainter {
 public:
  // Answers what panels wanted in the last frame. Call it once a frame.
  void update(Session& session);

 private:
  struct Preview {
    std::uint64_t version = 0;  // of the component that is on the picture
    gpu::Texture texture;
  };
  std::map<ecs::Entity, Preview> previews_;
};

}  // namespace lambent::editor
