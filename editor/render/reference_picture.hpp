// Shows the path-traced reference on the GPU: its newest snapshot with the exposure of the runtime's picture,
// or a heat map of its difference from a linear picture that the runtime renders for the same view. A texture
// goes out; error figures go to the session's ReferenceView. Main thread, with a current OpenGL context. A
// comparison waits for the GPU, once for each snapshot. Errors are logged.
#pragma once

#include <optional>

#include "editor/session/session.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/tone_map/tone_mapper.hpp"

namespace lambent::editor {

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

}  // namespace lambent::editor
