// Does everything that the editor does with OpenGL beside its widgets: the runtime's picture, the
// reference's, thumbnails, and the studies of what settings cost, one step a frame. Reads the session and
// writes what came of it there. Main thread; it lives as long as the window's context is current. Errors: no
// OpenGL 4.5.
#pragma once

#include "editor/render/picture.hpp"
#include "editor/render/reference_picture.hpp"
#include "editor/render/thumbnails.hpp"

namespace lambent::editor {

class Renderer {
 public:
  static Result<Renderer> create(const Session& session);

  // Draws the view in this size if anything moved, and all else that is due; call it once a frame.
  void update(Session& session, spec::Size size);
  // Returns what is seen at a point of the last picture, as Picture::pick().
  Result<std::optional<frame::Picked>> pick(Session& session, float x, float y) {
    return picture_.pick(session, x, y);
  }
  // The runtime's picture; row 0 is the bottom.
  const gpu::Texture& picture() const { return picture_.texture(); }
  // The reference or the heat map, as `split` says; row 0 is the top. No handle: nothing yet.
  const gpu::Texture& reference(SplitView split) const { return reference_.texture(split); }

 private:
  explicit Renderer(Picture picture) : picture_(std::move(picture)) {}

  Picture picture_;
  ReferencePicture reference_;
  Thumbnails thumbnails_;
};

}  // namespace lambent::editor
