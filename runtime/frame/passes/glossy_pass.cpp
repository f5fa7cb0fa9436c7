// Shades transferred light at the samples of glossy surfaces, of volumes and of grids, if any have matrices.
#include <algorithm>

#include "runtime/effects/glossy/glossy.hpp"
#include "runtime/frame/passes/passes.hpp"

namespace lambent::frame {

namespace {

class GlossyPass final : public FramePass {
 public:
  explicit GlossyPass(Blackboard& board)
      : FramePass({.name = "glossy",
                   .reads = resources<World, lighting::GroupLights>(),
                   .writes = resources<effects::glossy::Glossy>(),
                   .causes = kLightCauses,
                   .counts = {"cells_shaded"}}) {
    board.offer(glossy_);
  }

  bool due(const FrameContext& frame) override {
    return std::ranges::any_of(frame.world.residency().cells(), &streaming::ResidentCell::matrices);
  }
  Result<void> update(FrameContext& frame) override {
    const FrameSettings& settings = frame.settings();
    Result<void> done = glossy_.shade(
        frame.world.residency(), frame.read<lighting::GroupLights>(), settings.transfer, frame.counters(),
        {.surfaces = settings.glossy, .volumes = settings.volumes, .neighborhoods = settings.neighborhoods});
    if (frame.counters().dispatches > 0) frame.because("light");
    frame.count("cells_shaded", glossy_.cellsShadedLast());
    return done;
  }

 private:
  effects::glossy::Glossy glossy_;
};

}  // namespace

MadePass makeGlossyPass(const PassSetup& setup) {
  return std::make_unique<GlossyPass>(setup.board);
}

}  // namespace lambent::frame
