// Prepares surfaces for a view, as the settings of the frame say. The pass must read World, Diffuse and
// SeenSky, and write the prefiltered environment.
#pragma once

#include "runtime/frame/frame_context.hpp"
#include "runtime/surface/surfaces.hpp"

namespace lambent::frame {

Result<void> prepareSurfaces(FrameContext& frame, Surfaces& surfaces, const SurfaceModules& modules,
                             const spec::View& view, SurfaceView shown);

}  // namespace lambent::frame
