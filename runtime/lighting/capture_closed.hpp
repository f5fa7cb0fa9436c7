// Tells whether a level of a proxy consists of closed surfaces that face outwards. Then only bright sides are
// visible from outside its box, and the dark sides need not be drawn. Levels with double-sided triangles
// never count as closed.
#pragma once

#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::lighting::capture {

bool isClosed(const bundle::CaptureProxy& proxy, const bundle::ProxyLevel& level);

}  // namespace lambent::lighting::capture
