// Turns linear radiance into the picture; counts negative pixels, and clamps them for the eye.
#include <utility>

#include "runtime/frame/passes/passes.hpp"
#include "runtime/tone_map/tone_mapper.hpp"

namespace lambent::frame {

namespace {

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

}  // namespace

MadePass makeToneMapPass(const PassSetup& setup) {
  Result<ToneMapper> made = ToneMapper::create(samplesOf(setup.options.output), setup.options.linear());
  if (!made) return failAgain(made.error());
  return std::make_unique<ToneMapPass>(std::move(*made), setup.board);
}

}  // namespace lambent::frame
