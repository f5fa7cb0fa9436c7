// Renders the runtime's picture of the world from the editor's camera, whenever something that it shows has
// changed. The session comes in; a texture goes out, and PictureFacts for commands and panels. Only pick()
// waits for the GPU: times, exposure and negative pixels are read once a picture is finished. Main thread,
// with a current OpenGL context. Errors: no OpenGL 4.5; later errors are logged.
#pragma once

#include <optional>

#include "editor/render/camera_preview.hpp"
#include "editor/render/picture_clock.hpp"
#include "editor/session/session.hpp"
#include "runtime/frame/frame.hpp"

namespace lambent::editor {

class Picture {
 public:
  static Result<Picture> create(const Session& session);

  // Renders at this size if anything has changed. Call it once a frame.
  void update(Session& session, spec::Size size);
  // Returns what is visible at a pixel of the last picture, counted from the top left corner, or none for the
  // sky. Waits for the GPU.
  Result<std::optional<frame::Picked>> pick(Session& session, float x, float y);
  // Row 0 of the texture is the bottom.
  const gpu::Texture& texture() const { return frame_.picture(); }
  // Returns what the selected camera sees, as CameraPreview::texture().
  const gpu::Texture& preview() const { return preview_.texture(); }

 private:
  explicit Picture(frame::Frame frame) : frame_(std::move(frame)) {}
  Result<void> draw(Session& session, const spec::View& view, spec::Size size);
  void readFinished(Session& session);

  frame::Frame frame_;
  PictureClock clock_;
  CameraPreview preview_;
  // Identifies what the last picture showed.
  struct Drawn {
    std::uint64_t edits = 0;  // sum of the versions of history and selection
    spec::View view;
    spec::Size size;
  };
  Drawn drawn_;
  bool unread_ = false;  // exposure and negative pixels of the last picture are still to be read
};

}  // namespace lambent::editor
