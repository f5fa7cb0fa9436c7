// Does all OpenGL work of the editor except its widgets: the runtime's picture, the reference's, thumbnails,
// and the studies of what settings cost, one step a frame. It reads the session and writes its results there.
// Main thread; it must not outlive the window's OpenGL context. Errors: no OpenGL 4.5.
#pragma once

#include "editor/render/material_pictures.hpp"
#include "editor/render/picture.hpp"
#include "editor/render/reference_picture.hpp"
#include "editor/render/thumbnails.hpp"

namespace lambent::editor {

class Renderer {
 public:
  static Result<Renderer> create(const Session& session);

  // Renders the view at this size if anything changed, and does all other pending work. Call it once a frame.
  void update(Session& session, spec::Size size);
  // Returns what is visible at a pixel of the last picture, as Picture::pick().
  Result<std::optional<frame::Picked>> pick(Session& session, float x, float y) {
    return picture_.pick(session, x, y);
  }
  // Returns the runtime's picture; row 0 is the bottom.
  const gpu::Texture& picture() const { return picture_.texture(); }
  // Returns what the selected camera sees; row 0 is the bottom. It has no handle if none is selected.
  const gpu::Texture& preview() const { return picture_.preview(); }
  // Returns the reference or the heat map, as `split` says; row 0 is the top. It has no handle while there is
  // none.
  const gpu::Texture& reference(SplitView split) const { return reference_.texture(split); }

 private:
  explicit Renderer(Picture picture) : picture_(std::move(picture)) {}

  Picture picture_;
  ReferencePicture reference_;
  Thumbnails thumbnails_;
  MaterialPainter materials_;
};

}  // namespace lambent::editor
