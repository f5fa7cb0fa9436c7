// Updates the sky, as it is seen behind all surfaces and as rough mirrors show it.
#include <algorithm>
#include <optional>
#include <utility>

#include "runtime/base/change_gate.hpp"
#include "runtime/frame/passes/passes.hpp"
#include "runtime/lighting/prefiltered_environment.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/surface/light_modules.hpp"

namespace lambent::frame {

namespace {

using lighting::PrefilteredEnvironment;
using lighting::Sky;

class SkyPass final : public FramePass {
 public:
  SkyPass(Sky sky, Blackboard& board)
      : FramePass({.name = "sky",
                   .writes = resources<Sky>(),
                   .causes = static_cast<std::uint32_t>(Cause::Environment)}),
        sky_(std::move(sky)) {
    board.offer(sky_);
  }

  bool due(const FrameContext& frame) override { return !sky_.upToDate(frame.environment); }
  Result<void> update(FrameContext& frame) override {
    sky_.update(frame.environment);
    frame.because();
    return {};
  }

 private:
  Sky sky_;
};

// Prefilters the environment once for each set of lights, when there is a glossy surface to show it.
class PrefilteredEnvironmentPass final : public FramePass {
 public:
  explicit PrefilteredEnvironmentPass(Blackboard& board)
      : FramePass({.name = "specular environment",
                   .reads = resources<World, Sky>(),
                   .writes = resources<std::optional<PrefilteredEnvironment>>(),
                   .causes = static_cast<std::uint32_t>(Cause::Environment)}) {
    board.offer(prefiltered_);
    board.offer(module_);
    board.get<SurfaceModules>().push_back(&module_);
  }

  bool due(const FrameContext& frame) override {
    shown_ = frame.settings().residual;
    if (!frame.settings().residual || !frame.settings().glossy) return false;
    if (source_.holds(PrefilteredEnvironment::sourceVersion(frame.environment))) return false;
    // Matrices may belong to neighborhoods or volumes alone, which do not show it.
    return std::ranges::any_of(frame.world.residency().draws(), [](const streaming::ResidentDraw& draw) {
      return draw.glossy() || draw.layered;
    });
  }
  Result<void> update(FrameContext& frame) override {
    Result<PrefilteredEnvironment> made =
        PrefilteredEnvironment::make(frame.environment, frame.read<Sky>(), frame.counters());
    if (!made) return failAgain(made.error());
    prefiltered_ = std::move(*made);
    source_.renew(PrefilteredEnvironment::sourceVersion(frame.environment));
    frame.because("first needed");
    return {};
  }

 private:
  std::optional<PrefilteredEnvironment> prefiltered_;
  bool shown_ = true;
  SpecularEnvironmentModule module_{prefiltered_, shown_};
  ChangeGate<std::uint64_t> source_;
};

}  // namespace

MadePass makeSkyPass(const PassSetup& setup) {
  Result<Sky> sky = Sky::create(setup.environment);
  if (!sky) return failAgain(sky.error());
  return std::make_unique<SkyPass>(std::move(*sky), setup.board);
}

MadePass makePrefilteredEnvironmentPass(const PassSetup& setup) {
  return std::make_unique<PrefilteredEnvironmentPass>(setup.board);
}

}  // namespace lambent::frame
