// Whether a level of a proxy is made of closed surfaces that face outwards, so that from outside its box only
// the bright sides can be seen and the others need not be drawn. Double-sided triangles never are.
#pragma once

#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::lighting::capture {

bool isClosed(const bundle::CaptureProxy& proxy, const bundle::ProxyLevel& level);

}  // namespace lambent::lighting::capture
