// Does all OpenGL work of the editor except its widgets: the runtime's picture, the reference's, thumbnails,
// and the studies of what settings cost, one step a frame. It reads the session and writes its results
// there. Main thread; it must not outlive the window's OpenGL context. Errors: no OpenGL 4.5.
#pragma once

#include <optional>

#include "editor/render/picture.hpp"
#include "editor/render/thumbnails.hpp"
#include "editor/session/session.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/tone_map/tone_mapper.hpp"

namespace lambent::editor {

// Shows the path-traced reference: its newest snapshot with the exposure of the runtime's picture, or a heat
// map of its difference from a linear picture that the runtime renders for the same view. Error figures go
// to the session's ReferenceView. A comparison waits for the GPU, once for each snapshot. Errors are logged.
class ReferencePicture {
 public:
  // Follows the session's reference. Call it once a frame, after the runtime's picture was rendered.
  void update(Session& session);
  // Returns the texture to show, row 0 at the top. It has no handle while there is nothing to show.
  const gpu::Texture& texture(SplitView split) const { return split == SplitView::Heat ? heat_ : shown_; }

 private:
  Result<void> show(Session& session, const baker::reference::Snapshot& snapshot);
  Result<void> compare(Session& session, const baker::reference::Snapshot& snapshot);
  Result<spec::RgbaImage> linearPicture(Session& session, spec::Size size);

  std::optional<frame::ToneMapper> tone_mapper_;
  std::optional<frame::Frame> linear_;
  gpu::Texture radiance_, shown_, heat_;
  gpu::Framebuffer shown_target_;
  float exposure_ev_ = 0.0f;  // of shown_
};

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
