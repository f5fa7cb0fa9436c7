// The room baker/proxy makes the capture proxy: a rigid group in a few triangles, as other groups see it when
// they sample their light. Geometry, samples and colours of the group, as they ship, and their importance
// come in; the payload's content in the group's frame goes out, with levels of at most 256, 64 and 16
// triangles. It works on several threads and has no errors.
#pragma once

#include "baker/importance/importance.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/surface_colors.hpp"
#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::baker {

// Returns no level if the group shows nothing: it has no area, or only surfaces that are mostly transparent.
bundle::CaptureProxy makeCaptureProxy(const GroupGeometry& geometry, const SampleSet& samples,
                                      const SurfaceColors& colors, const Importance& importance);

}  // namespace lambent::baker
