// What bodies hide of lamps that shine per pixel, where these bodies reach a group by their grids and are
// left out of its captures: shadow cubes know it of straight light, and by this its bounced light does. Rays
// from the light probes to the lamps, among the bodies' proxies. No GL.
#pragma once

#include <span>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/shadows/lit_scene.hpp"

namespace lambent::frame {

// Fills IncidentGroup::open of all groups; samples_ws and left_out must be as they stay. proxies: by
// CaptureBody::proxy.
void hideApart(LitScene& scene, std::span<const bundle::CaptureProxy* const> proxies);

}  // namespace lambent::frame
