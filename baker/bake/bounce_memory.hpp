// Keeps the memory of bounces within the limit of a bake (BakeOptions::effectiveMemory). Hits that were kept
// for them are given up where their results need the room, and are traced again then.
#pragma once

#include "baker/bake/surface_transport.hpp"

namespace lambent::baker {

// Must be called when direct light is traced and before bounces begin.
void makeRoomForBounces(const BakeOptions& options, SurfaceTransport& light);

}  // namespace lambent::baker
