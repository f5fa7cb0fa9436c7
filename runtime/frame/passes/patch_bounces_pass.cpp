// Bounces lights among the surfaces, and key lights, by patches.
#include "runtime/bounces/patch_bounces.hpp"
#include "runtime/frame/passes/passes.hpp"
#include "runtime/surface/light_modules.hpp"

namespace lambent::frame {

namespace {

class PatchBouncesPass final : public FramePass {
 public:
  explicit PatchBouncesPass(Blackboard& board)
      : FramePass({.name = "patch bounces",
                   .reads = resources<World, LitScene, lighting::GroupLights>(),
                   .writes = resources<PatchBounces>(),
                   .causes = kLightCauses,
                   .counts = {"patch_rooms", "patch_rooms_to_come", "patches", "lights_bounced",
                              "patch_draws_gathered"}}) {
    board.offer(bounces_);
    board.get<SurfaceModules>().push_back(&module_);
  }

  bool due(const FrameContext& frame) override {
    return !frame.read<LitScene>().shadowed_lights.empty() || !frame.keys().empty() || bounces_.any();
  }
  Result<void> update(FrameContext& frame) override {
    const FrameSettings& settings = frame.settings();
    const bool on = settings.patch_bounces && settings.transfer == evaluate::TransferMode::Full;
    Result<void> done = bounces_.update(frame.world, frame.read<LitScene>(),
                                        {.keys = frame.keys(), .bands = &frame.read<lighting::GroupLights>()},
                                        on, frame.options.wait_for_captures, frame.counters());
    const PatchBounceCounts& counts = bounces_.counts();
    frame.count("patch_rooms", counts.rooms);
    frame.count("patch_rooms_to_come", counts.rooms_to_come);
    frame.count("patches", counts.patches);
    frame.count("lights_bounced", counts.lights_bounced);
    frame.count("patch_draws_gathered", counts.draws_gathered);
    if (frame.counters().uploaded_bytes > 0) frame.because("lights that patches send on");
    return done;
  }

 private:
  PatchBounces bounces_;
  BounceModule module_{bounces_};
};

}  // namespace

MadePass makePatchBouncesPass(const PassSetup& setup) {
  return std::make_unique<PatchBouncesPass>(setup.board);
}

}  // namespace lambent::frame
