// Draws overlays and wires of triangles over the finished picture.
#include <optional>
#include <utility>

#include "runtime/base/change_gate.hpp"
#include "runtime/debug/data_view.hpp"
#include "runtime/debug/overlays.hpp"
#include "runtime/frame/passes/passes.hpp"

namespace lambent::frame {

namespace {

using effects::diffuse::Proxies;

class OverlayPass final : public FramePass {
 public:
  OverlayPass()
      : FramePass({.name = "overlays",
                   .reads = resources<World, PictureTargets, lighting::Sky, LitScene, lighting::GroupLights,
                                      Neighborhoods, KeyShadows, Proxies, ToneMapper>(),
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
                             frame.read<lighting::Sky>(),
                             frame.read<LitScene>(),
                             frame.read<lighting::GroupLights>(),
                             frame.read<Neighborhoods>(),
                             frame.read<KeyShadows>(),
                             frame.read<Proxies>(),
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

MadePass makeOverlayPass(const PassSetup&) {
  return std::make_unique<OverlayPass>();
}

}  // namespace lambent::frame
