// The passes that finish a picture: exposure and colours, then overlays.
#include <optional>
#include <utility>

#include "runtime/base/change_gate.hpp"
#include "runtime/debug/data_view.hpp"
#include "runtime/debug/overlays.hpp"
#include "runtime/frame/pass_list.hpp"
#include "runtime/tone_map/tone_mapper.hpp"

namespace lambent::frame {

namespace {

// Turns linear radiance into the picture; counts negative pixels, and clamps them for the eye.
class ToneMapPass final : public FramePass {
 public:
  ToneMapPass(ToneMapper tone_mapper, Blackboard& board)
      : FramePass({.name = "tone map",
                   .reads = resources<PictureTargets>(),
                   .writes = resources<PictureTargets, ToneMapper>(),
                   .causes = kPictureCauses | Cause::Exposure}),
        tone_mapper_(std::move(tone_mapper)) {
    board.offer(tone_mapper_);
  }

  bool due(const FrameContext& frame) override {
    return frame.options.destination != Destination::Shared;  // whose owner does it
  }
  Result<void> update(FrameContext& frame) override {
    frame.targets.bindPicture();
    frame.because();
    tone_mapper_.run(frame.targets.hdr(), frame.settings().exposure_ev, frame.counters(),
                     !showsLight(frame.options.view.view));
    return {};
  }

 private:
  ToneMapper tone_mapper_;
};

// Draws overlays and wires of triangles over the finished picture.
class OverlayPass final : public FramePass {
 public:
  OverlayPass()
      : FramePass({.name = "overlays",
                   .reads = resources<World, PictureTargets, LitScene, lighting::GroupLights, Neighborhoods,
                                      KeyShadows, ToneMapper>(),
                   .writes = resources<PictureTargets>(),
                   .causes = kPictureCauses}) {}

  bool due(const FrameContext& frame) override {
    const bool wires = showsWires(frame);
    if (!wires) wires_.reset();
    const bool any = wires || frame.options.overlays.any();
    if (!any) overlays_.reset();
    return any;
  }
  Result<void> update(FrameContext& frame) override {
    frame.because();
    const bool wires = showsWires(frame);
    if (Result<void> done = attach(frame); !done) return done;
    if (wires && !wires_) wires_.emplace(frame.options.linear());
    const auto drawWires = [&]() -> Result<void> {
      if (!wires) return {};
      return wires_->drawWires(frame.world, *frame.view, frame.counters());
    };
    const OverlayScene scene{frame.world,
                             frame.environment,
                             frame.read<LitScene>(),
                             frame.read<lighting::GroupLights>(),
                             frame.read<Neighborhoods>(),
                             frame.read<KeyShadows>(),
                             frame.read<ToneMapper>(),
                             *frame.view,
                             frame.targets.size()};
    if (Result<void> done = overlays_->draw(frame.options.overlays, scene, drawWires, frame.counters());
        !done)
      return done;
    frame.targets.bindPicture();
    overlays_->layOver(frame.counters());
    return {};
  }

 private:
  static bool showsWires(const FrameContext& frame) {
    return frame.options.view.view == SurfaceView::Wireframe;
  }
  Result<void> attach(const FrameContext& frame) {
    if (!targets_.renew(frame.targets.version()) && overlays_) return {};
    Result<Overlays> made = Overlays::create(frame.targets.hdr().desc().samples, frame.options.linear());
    if (!made) return failAgain(made.error());
    overlays_ = std::move(*made);
    overlays_->attach(frame.targets.depth(), frame.targets.size());
    return {};
  }

  std::optional<Overlays> overlays_;  // made while any are shown
  std::optional<DataView> wires_;     // made while a view shows wires
  ChangeGate<std::uint64_t> targets_;
};

}  // namespace

MadePass makeToneMapPass(const PassSetup& setup) {
  Result<ToneMapper> made = ToneMapper::create(samplesOf(setup.options.output), setup.options.linear());
  if (!made) return failAgain(made.error());
  return std::make_unique<ToneMapPass>(std::move(*made), setup.board);
}

MadePass makeOverlayPass(const PassSetup&) {
  return std::make_unique<OverlayPass>();
}

}  // namespace lambent::frame
