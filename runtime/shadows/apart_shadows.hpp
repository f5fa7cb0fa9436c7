// Finds what bodies hide of lamps that are shaded per pixel, when these bodies reach a group by their
// neighborhood grids and are left out of its captures. Shadow cubes occlude the direct light of such lamps;
// this gives the occlusion for their bounced light. It traces rays from the light probes to the lamps among
// the bodies' proxies. No GL.
#pragma once

#include <span>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/shadows/lit_scene.hpp"

namespace lambent::frame {

// Fills IncidentGroup::open of all groups; their samples_ws and left_out must be final. `proxies` is indexed
// by CaptureBody::proxy.
void hideApart(LitScene& scene, std::span<const bundle::CaptureProxy* const> proxies);

}  // namespace lambent::frame
