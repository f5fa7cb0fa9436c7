// Draws the runtime's picture of the world as the editor looks at it, anew when anything that it shows has
// changed, and only then. The session comes in; a texture goes out, and PictureFacts for commands and panels.
// Nothing here waits for the GPU but pick(): times, exposure and negative pixels are read once a picture is
// finished. Main thread, with a current OpenGL context. Errors: no OpenGL 4.5; what goes wrong later is
// logged.
#pragma once

#include <optional>

#include "editor/render/picture_clock.hpp"
#include "editor/session/session.hpp"
#include "runtime/frame/frame.hpp"

namespace lambent::editor {

class Picture {
 public:
  static Result<Picture> create(const Session& session);

  // Draws in this size if anything has changed; call it once a frame.
  void update(Session& session, spec::Size size);
  // Returns what is seen at a point of the last picture, in its pixels from the top left corner; nothing: the
  // sky. Waits for the GPU.
  Result<std::optional<frame::Picked>> pick(Session& session, float x, float y);
  // Row 0 is the bottom.
  const gpu::Texture& texture() const { return frame_.picture(); }

 private:
  explicit Picture(frame::Frame frame) : frame_(std::move(frame)) {}
  Result<void> draw(Session& session, const spec::View& view, spec::Size size);
  void readFinished(Session& session);

  frame::Frame frame_;
  PictureClock clock_;
  // What the last picture was of.
  struct Drawn {
    std::uint64_t edits = 0;  // sum of the versions of history and selection
    spec::View view;
    spec::Size size;
  };
  Drawn drawn_;
  bool unread_ = false;  // exposure and negative pixels of the last picture
};

}  // namespace lambent::editor
