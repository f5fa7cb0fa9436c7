#include "runtime/frame/passes/prepare_surfaces.hpp"

#include <algorithm>
#include <optional>

#include "runtime/effects/diffuse/diffuse.hpp"
#include "runtime/evaluate/seen_sky.hpp"
#include "runtime/lighting/prefiltered_environment.hpp"

namespace lambent::frame {

Result<void> prepareSurfaces(FrameContext& frame, Surfaces& surfaces, const SurfaceModules& modules,
                             const spec::View& view, SurfaceView shown) {
  surfaces.setView(shown);
  const FrameSettings& settings = frame.settings();
  auto& prefiltered = frame.write<std::optional<lighting::PrefilteredEnvironment>>();
  if (prefiltered && settings.residual) {
    std::uint32_t order = 1;
    for (const streaming::ResidentGroup& group : frame.world.residency().groups())
      order = std::max(order, group.order);
    order = std::min(order, settings.order);
    prefiltered->update(frame.environment, static_cast<int>(order), settings.window, frame.counters());
  }
  return surfaces.prepare(frame.world, frame.read<effects::diffuse::Diffuse>(), view,
                          {.options = {.diffuse = settings.diffuse,
                                       .glossy = settings.glossy,
                                       .glossy_bands = settings.glossy_order},
                           .seen_sky = &frame.read<evaluate::SeenSky>(),
                           .modules = modules},
                          frame.counters());
}

}  // namespace lambent::frame
