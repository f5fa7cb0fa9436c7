// The passes that prepare light which pictures look up per pixel: the sky, and shadow maps.
#include <algorithm>
#include <optional>
#include <utility>

#include "runtime/base/change_gate.hpp"
#include "runtime/frame/frame_pass.hpp"
#include "runtime/light_plan/light_plan.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/shadows/local_shadows.hpp"
#include "runtime/surface/reflection_probes.hpp"

namespace lambent::frame {

namespace {

// Updates the sky, as it is seen behind all surfaces and as rough mirrors show it.
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

// Draws the shadow cubes of local lights and the shadow maps of key lights, for direct light per pixel.
class LocalShadowsPass final : public FramePass {
 public:
  explicit LocalShadowsPass(Blackboard& board)
      : FramePass({.name = "shadows",
                   .reads = resources<World, LightPlan>(),
                   .writes = resources<LocalShadows>(),
                   .causes = kLightCauses | Cause::Materials,
                   .counts = {"shadow_cubes_drawn"}}) {
    board.offer(shadows_);
    board.get<SurfaceModules>().push_back(&shadows_);
  }

  Result<void> update(FrameContext& frame) override {
    const auto& scene = frame.read<LightPlan>();
    Result<void> done = shadows_.update(frame.world, scene.shadowed_lights, scene.pixel_masks,
                                        frame.counters(), scene.own_lamps);
    if (shadows_.cubesDrawn() > 0) frame.because("lights among surfaces");
    frame.count("shadow_cubes_drawn", shadows_.cubesDrawn());
    return done;
  }
  void forget() override { shadows_.forget(); }

 private:
  LocalShadows shadows_;
};

class KeyShadowsPass final : public FramePass {
 public:
  explicit KeyShadowsPass(Blackboard& board)
      : FramePass({.name = "key shadows",
                   .reads = resources<World>(),
                   .writes = resources<KeyShadows>(),
                   .causes = kPictureCauses,
                   .counts = {"key_lights", "key_maps_drawn"}}) {
    board.offer(shadows_);
    board.get<SurfaceModules>().push_back(&shadows_);
  }

  bool due(const FrameContext& frame) override { return !frame.environment.keys().empty() || shadows_.any(); }
  Result<void> update(FrameContext& frame) override {
    const FrameSettings& settings = frame.settings();
    Result<void> done =
        shadows_.update(frame.world, frame.keys(), *frame.view,
                        {.finest = settings.key_size, .samples = settings.key_samples}, frame.counters());
    if (shadows_.mapsDrawn() > 0) frame.because();
    frame.count("key_lights", frame.environment.keys().size());
    frame.count("key_maps_drawn", shadows_.mapsDrawn());
    return done;
  }
  void forget() override { shadows_.forget(); }

 private:
  KeyShadows shadows_;
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

MadePass makeLocalShadowsPass(const PassSetup& setup) {
  return std::make_unique<LocalShadowsPass>(setup.board);
}

MadePass makeKeyShadowsPass(const PassSetup& setup) {
  return std::make_unique<KeyShadowsPass>(setup.board);
}

}  // namespace lambent::frame
