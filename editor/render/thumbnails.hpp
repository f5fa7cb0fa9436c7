// Owns the textures of small pictures: those of assets, which the session finds on the CPU or which are
// taken from the view, and those of materials. Main thread, with a current OpenGL context.
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "editor/session/asset_pictures.hpp"
#include "editor/session/session.hpp"
#include "runtime/base/change_gate.hpp"
#include "runtime/gpu/objects.hpp"

namespace lambent::editor {

class Thumbnails {
 public:
  // Uploads new pictures, and tells the session their textures. When a scene or a world that is shown has
  // come to rest, a small copy of `view` (row 0 at the bottom) becomes its picture; so again when a better
  // bake is shown. A scene beside others that has no picture gets the part of the view around it. Call it
  // once a frame.
  void update(Session& session, const gpu::Texture& view);

 private:
  // Holds a file, and the part of the view that shows its contents.
  struct Shown {
    Asset asset;
    PicturePart part;
    bool operator==(const Shown&) const = default;
  };
  // size: of the view in pixels.
  static std::vector<Shown> shownIn(Session& session, const spec::Size& size);
  void takeFromView(Session& session, const gpu::Texture& view);

  std::map<std::filesystem::path, gpu::Texture> textures_;
  // Tells when the view's picture must be taken: it compares the files that it shows and the version of the
  // scenes.
  ChangeGate<std::vector<Shown>, std::uint64_t> taken_;
};

// Makes the pictures of the materials that panels ask for: a sphere of each, drawn anew when the material
// changes, and its textures as they are on the GPU.
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
