// Draws what the selected camera, or one that is kept, sees into a small picture of its own, by the frame of
// the main picture: a second frame would keep light probes, captures and shading of its own. The main picture
// must be drawn anew afterwards. It draws only when something in it changed: while the world comes to rest,
// and while main pictures are slow and move, it waits. Main thread, with a current OpenGL context.
#pragma once

#include "editor/session/session.hpp"
#include "runtime/frame/frame.hpp"

namespace lambent::editor {

class CameraPreview {
 public:
  // Returns whether the preview is to be drawn now. edits: a number that rises with edits and selections.
  // stale: the main picture changes by something else than edits and its view.
  bool due(Session& session, std::uint64_t edits, bool stale);
  // Draws it. Errors: those of the camera and the frame.
  Result<void> draw(Session& session, frame::Frame& frame);
  // Returns the picture, with row 0 at the bottom, or one without handle if no camera is shown.
  const gpu::Texture& texture() const { return texture_; }

 private:
  gpu::Texture texture_;
  ecs::Entity camera_;
  std::uint64_t edits_ = 0;
  bool stale_ = true;
};

}  // namespace lambent::editor
