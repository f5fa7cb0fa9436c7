// Draws the shadow cubes of local lights and the shadow maps of key lights, for direct light per pixel.
#include "runtime/frame/passes/passes.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "runtime/shadows/local_shadows.hpp"
#include "runtime/surface/light_modules.hpp"

namespace lambent::frame {

namespace {

class LocalShadowsPass final : public FramePass {
 public:
  explicit LocalShadowsPass(Blackboard& board)
      : FramePass({.name = "shadows",
                   .reads = resources<World, LitScene>(),
                   .writes = resources<LocalShadows>(),
                   .causes = kLightCauses | Cause::Materials,
                   .counts = {"shadow_cubes_drawn"}}) {
    board.offer(shadows_);
    board.get<SurfaceModules>().push_back(&module_);
  }

  Result<void> update(FrameContext& frame) override {
    const auto& scene = frame.read<LitScene>();
    Result<void> done = shadows_.update(frame.world, scene.shadowed_lights, scene.pixel_masks,
                                        frame.counters(), scene.own_lamps);
    if (shadows_.cubesDrawn() > 0) frame.because("lights among surfaces");
    frame.count("shadow_cubes_drawn", shadows_.cubesDrawn());
    return done;
  }
  void forget() override { shadows_.forget(); }

 private:
  LocalShadows shadows_;
  LocalLightModule module_{shadows_};
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
    board.get<SurfaceModules>().push_back(&module_);
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
  KeyLightModule module_{shadows_};
};

}  // namespace

MadePass makeLocalShadowsPass(const PassSetup& setup) {
  return std::make_unique<LocalShadowsPass>(setup.board);
}

MadePass makeKeyShadowsPass(const PassSetup& setup) {
  return std::make_unique<KeyShadowsPass>(setup.board);
}

}  // namespace lambent::frame
