// Shades E/pi at every vertex whose light or transfer changed.
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/frame/passes/passes.hpp"

namespace lambent::frame {

namespace {

class DiffusePass final : public FramePass {
 public:
  explicit DiffusePass(Blackboard& board)
      : FramePass({.name = "shade",
                   .reads = resources<World, lighting::GroupLights>(),
                   .writes = resources<effects::diffuse::Diffuse>(),
                   .causes = kLightCauses,
                   .counts = {"cells_shaded", "draws_shaded"}}) {
    board.offer(diffuse_);
  }

  Result<void> update(FrameContext& frame) override {
    const FrameSettings& settings = frame.settings();
    Result<void> done =
        diffuse_.shade(frame.world.residency(), frame.read<lighting::GroupLights>(), settings.transfer,
                       frame.counters(), {.surfaces = settings.diffuse, .volumes = settings.volumes});
    if (frame.counters().dispatches > 0) frame.because("light");
    frame.count("cells_shaded", diffuse_.shadedLast().cells);
    frame.count("draws_shaded", diffuse_.shadedLast().draws);
    return done;
  }

 private:
  effects::diffuse::Diffuse diffuse_;
};

}  // namespace

MadePass makeDiffusePass(const PassSetup& setup) {
  return std::make_unique<DiffusePass>(setup.board);
}

}  // namespace lambent::frame
