// A rigid group in a few triangles, as other groups see it when they sample their light (design: "capture
// proxy"). Made of what ships; levels of at most 256, 64 and 16 triangles. Comes in: geometry, samples and
// colours of the group; goes out: the payload's content, in the group's frame.
#pragma once

#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/surface_colors.hpp"
#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::baker {

// Without a level where the group shows nothing: no area, or only what is mostly transparent.
bundle::CaptureProxy makeCaptureProxy(const GroupGeometry& geometry, const SampleSet& samples,
                                      const SurfaceColors& colors);

}  // namespace lambent::baker
