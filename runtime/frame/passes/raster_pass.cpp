// Draws surfaces, proxies of bundles that are not resident, the sky and blended surfaces, as linear radiance.
// In views of transfer it draws numbers instead of light.
#include <algorithm>
#include <optional>
#include <utility>

#include "runtime/bounces/patch_bounces.hpp"
#include "runtime/debug/data_view.hpp"
#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/frame/passes/passes.hpp"
#include "runtime/frame/passes/prepare_surfaces.hpp"
#include "runtime/lighting/prefiltered_environment.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/shadows/key_shadows.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "runtime/shadows/local_shadows.hpp"
#include "runtime/surface/neighborhoods.hpp"
#include "runtime/surface/proxy_lods.hpp"
#include "runtime/surface/reflection_probes.hpp"
#include "runtime/surface/surfaces.hpp"

namespace lambent::frame {

namespace {

using effects::diffuse::Diffuse;
using lighting::GroupLights;
using lighting::Sky;
using Prefiltered = std::optional<lighting::PrefilteredEnvironment>;

class RasterPass final : public FramePass {
 public:
  RasterPass(Surfaces surfaces, Blackboard& board)
      : FramePass(
            {.name = "raster",
             .reads = resources<World, LitScene, GroupLights, Diffuse, Neighborhoods, PatchBounces, Sky,
                                evaluate::SeenSky, Prefiltered, LocalShadows, KeyShadows, ReflectionProbes>(),
             .writes = resources<PictureTargets, Surfaces, std::optional<DataView>, Prefiltered, LocalShadows,
                                 KeyShadows>(),
             .causes = kPictureCauses,
             .counts = {"draws_out_of_view"}}),
        surfaces_(std::move(surfaces)),
        modules_(board.get<SurfaceModules>()) {
    board.offer(surfaces_);
    board.offer(data_view_);
  }

  Result<void> update(FrameContext& frame) override {
    frame.because();
    // Surfaces are prepared even if numbers are drawn, because picking reads them.
    if (Result<void> done = prepareSurfaces(frame, surfaces_, modules_, *frame.view, frame.options.view.view);
        !done)
      return done;
    if (showsTransfer(frame.options.view.view)) return drawNumbers(frame);
    frame.count("draws_out_of_view", surfaces_.countOutOfView());
    data_view_.reset();
    return drawLight(frame);
  }

 private:
  Result<void> drawNumbers(FrameContext& frame) {
    if (!data_view_) data_view_.emplace(/*numbers=*/frame.options.linear());
    if (Result<void> done = data_view_->update(frame.world, frame.read<GroupLights>(), frame.options.view,
                                               frame.settings().transfer, frame.counters());
        !done)
      return done;
    clearTargets(frame);
    return data_view_->draw(frame.world, *frame.view, frame.counters());
  }

  Result<void> drawLight(FrameContext& frame) {
    const spec::View& view = *frame.view;
    const SurfaceView shown = frame.options.view.view;
    frame.write<LocalShadows>().bind(view, frame.targets.size());
    frame.write<KeyShadows>().bind(view, frame.targets.size());
    clearTargets(frame);
    surfaces_.drawOpaque(frame.world, frame.counters());
    if (shown == SurfaceView::Final || shown == SurfaceView::Wireframe) {
      if (Result<void> done =
              proxy_lods_.prepare(frame.world, frame.environment, frame.read<LitScene>().lights,
                                  {.order = frame.settings().order,
                                   .window = frame.settings().window,
                                   .diffuse = frame.settings().diffuse},
                                  frame.counters());
          !done)
        return done;
      proxy_lods_.draw(view, frame.counters());
    }
    if (showsLight(shown) && frame.options.show_sky) {
      frame.read<Sky>().draw(frame.environment, view.view_from_world, view.clip_from_view,
                             frame.targets.size().height, frame.counters());
      glDepthFunc(GL_LESS);
    }
    surfaces_.drawBlended(frame.world, frame.counters());
    return {};
  }

  static void clearTargets(FrameContext& frame) {
    // Pictures of numbers and directions have a dark grey behind them that no value has.
    constexpr float kGrey = 0.012f;
    frame.targets.bindCleared(showsLight(frame.options.view.view) || frame.options.linear() ? 0.0f : kGrey);
  }

  Surfaces surfaces_;
  const SurfaceModules& modules_;
  ProxyLods proxy_lods_;
  std::optional<DataView> data_view_;  // made while a view shows transfer
};

}  // namespace

MadePass makeRasterPass(const PassSetup& setup) {
  Result<Surfaces> surfaces = Surfaces::create(/*finest_texels=*/setup.options.linear());
  if (!surfaces) return failAgain(surfaces.error());
  return std::make_unique<RasterPass>(std::move(*surfaces), setup.board);
}

}  // namespace lambent::frame
