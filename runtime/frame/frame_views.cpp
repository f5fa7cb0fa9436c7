// What Frame shows besides light: numbers in its place, and overlays.
#include "runtime/frame/frame.hpp"

namespace lambent::frame {

void Frame::clearPicture() {
  glBindFramebuffer(GL_FRAMEBUFFER, hdr_target_.id());
  glViewport(0, 0, static_cast<GLsizei>(options_.size.width), static_cast<GLsizei>(options_.size.height));
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  // Behind numbers and directions there is a dark grey that neither has.
  constexpr float kGrey = 0.012f, kFar = 1.0f;
  const float grey = showsLight(options_.view.view) || options_.output == Output::Linear ? 0.0f : kGrey;
  const float background[] = {grey, grey, grey, 0.0f};
  glClearNamedFramebufferfv(hdr_target_.id(), GL_COLOR, 0, background);
  glClearNamedFramebufferfv(hdr_target_.id(), GL_DEPTH, 0, &kFar);
}

Result<void> Frame::drawNumbers(World& world, const spec::View& view, gpu::Counters& counters) {
  if (!data_view_) data_view_.emplace(/*numbers=*/options_.output == Output::Linear);
  if (Result<void> done =
          data_view_->update(world, group_lights_, options_.view, options_.settings.transfer, counters);
      !done)
    return done;
  clearPicture();
  return data_view_->draw(world, view, counters);
}

Result<void> Frame::drawOverlays(World& world, const lighting::Environment& environment,
                                 const spec::View& view) {
  const bool wires = options_.view.view == SurfaceView::Wireframe;
  if (!wires) wires_.reset();
  if (!wires && !options_.overlays.any()) {
    overlays_.reset();
    return {};
  }
  gpu::PassTimers::Scope pass(timers_, "overlays");
  pass.because(invalidation_log_.of(kPictureCauses));
  const bool linear = options_.output == Output::Linear;
  if (!overlays_) {
    Result<Overlays> made = Overlays::create(hdr_.desc().samples, linear);
    if (!made) return failAgain(made.error());
    overlays_ = std::move(*made);
    overlays_->attach(depth_, options_.size);
  }
  if (wires && !wires_) wires_.emplace(linear);
  const auto drawWires = [&]() -> Result<void> {
    if (!wires) return {};
    return wires_->drawWires(world, view, pass.counters());
  };
  const OverlayScene scene{world,        environment, sky_,         lit_scene_, group_lights_, neighborhoods_,
                           key_shadows_, proxies_,    tone_mapper_, view,       options_.size};
  if (Result<void> done = overlays_->draw(options_.overlays, scene, drawWires, pass.counters()); !done)
    return done;
  glBindFramebuffer(GL_FRAMEBUFFER, options_.to_window ? 0 : picture_target_.id());
  overlays_->layOver(pass.counters());
  return {};
}

}  // namespace lambent::frame
