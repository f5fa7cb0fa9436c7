// Uploads what has arrived, within a budget of bytes, and updates nodes, rigid groups, materials and
// the suns of the scene.
#include <chrono>
#include <optional>

#include "runtime/frame/pass_list.hpp"
#include "runtime/light_plan/light_plan.hpp"
#include "runtime/world/frame_times.hpp"

namespace lambent::frame {

namespace {

class UploadPass final : public FramePass {
 public:
  UploadPass()
      : FramePass({.name = "upload",
                   .writes = resources<World>(),
                   .causes = static_cast<std::uint32_t>(Cause::Arrived),
                   .counts = {"volumes"}}) {}

  Result<void> update(FrameContext& frame) override {
    const std::uint64_t most = frame.options.upload_budget_bytes;
    if (frame.view) noticeFrame(most);
    Result<void> done = frame.options.pace_uploads
                            ? frame.world.upload(pacer_.budget(most), frame.counters(), pacer_.waitSeconds())
                            : frame.world.upload(most, frame.counters());
    uploaded_bytes_ += frame.counters().uploaded_bytes;
    frame.log.noticeArrivals(frame.world, frame.counters().uploaded_bytes);
    frame.because();
    frame.count("volumes", frame.world.residency().volumes().size());
    return done;
  }

 private:
  // Records the time from one picture to the next, with the steps between them.
  void noticeFrame(std::uint64_t most_bytes) {
    const auto now = std::chrono::steady_clock::now();
    if (rendered_)
      pacer_.frameTook(std::chrono::duration<double, std::milli>(now - *rendered_).count(),
                       uploaded_bytes_ > 0, most_bytes);
    rendered_ = now;
    uploaded_bytes_ = 0;
  }

  UploadPacer pacer_;
  std::optional<std::chrono::steady_clock::time_point> rendered_;  // time of the last picture
  std::uint64_t uploaded_bytes_ = 0;                               // since the last picture
};

class TransformsPass final : public FramePass {
 public:
  TransformsPass()
      : FramePass({.name = "transforms",
                   .reads = resources<World>(),
                   .writes = resources<World>(),
                   .causes = Cause::Moved | Cause::Materials}) {}

  Result<void> update(FrameContext& frame) override {
    frame.world.updateTransforms();
    frame.world.updateMaterials();
    frame.environment.setSuns(sunsOf(frame.world, frame.environment.mostKeys()).discs);
    frame.log.noticeEnvironment(frame.environment);
    frame.log.noticeWorld(frame.world);
    frame.because();
    return {};
  }
};

}  // namespace

MadePass makeUploadPass(const PassSetup&) {
  return std::make_unique<UploadPass>();
}

MadePass makeTransformsPass(const PassSetup&) {
  return std::make_unique<TransformsPass>();
}

}  // namespace lambent::frame
