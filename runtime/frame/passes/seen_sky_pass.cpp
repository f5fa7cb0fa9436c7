// Computes what the vertices of layered draws see of the sky, when their transfer has arrived.
#include <algorithm>

#include "runtime/evaluate/seen_sky.hpp"
#include "runtime/frame/passes/passes.hpp"

namespace lambent::frame {

namespace {

class SeenSkyPass final : public FramePass {
 public:
  explicit SeenSkyPass(Blackboard& board)
      : FramePass({.name = "seen sky",
                   .reads = resources<World, lighting::GroupLights>(),
                   .writes = resources<evaluate::SeenSky>()}) {
    board.offer(seen_sky_);
  }

  bool due(const FrameContext& frame) override {
    return std::ranges::any_of(frame.world.residency().draws(), &streaming::ResidentDraw::layered);
  }
  Result<void> update(FrameContext& frame) override {
    Result<void> done =
        seen_sky_.update(frame.world.residency(), frame.read<lighting::GroupLights>(), frame.counters());
    if (frame.counters().dispatches > 0) frame.because("transfer arrived");
    return done;
  }

 private:
  evaluate::SeenSky seen_sky_;
};

}  // namespace

MadePass makeSeenSkyPass(const PassSetup& setup) {
  return std::make_unique<SeenSkyPass>(setup.board);
}

}  // namespace lambent::frame
