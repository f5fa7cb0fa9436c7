// Shows the reference on the GPU: its newest snapshot with the exposure of the runtime's picture, and a heat
// map of how it differs from a linear picture that the runtime draws for the same view. Goes out: a texture
// to show; figures go to the session's ReferenceView. Main thread, with a current OpenGL context; comparing
// waits for the GPU, once for each snapshot. What goes wrong is logged.
#pragma once

#include <optional>

#include "editor/session/session.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/tone_map/tone_mapper.hpp"

namespace lambent::editor {

class ReferencePicture {
 public:
  // Follows the session's reference; call it once a frame, after the runtime's picture was drawn.
  void update(Session& session);
  // Returns what to show, row 0 at the top; no handle: nothing yet.
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

}  // namespace lambent::editor
