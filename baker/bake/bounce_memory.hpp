// Keeps the memory of bounces within the limit of a bake (BakeOptions::effectiveMemory). Hits that were kept
// for them are given up where their results need the room, and are traced again then.
#pragma once

#include <cstdint>

#include "baker/bake/surface_transport.hpp"

namespace lambent::baker {

// Returns how many bytes the results of bounces take at most, beyond what direct light holds.
std::uint64_t bytesOfBounces(const SurfaceTransport& light, const BakeOptions& options);
void makeRoomForBounces(const BakeOptions& options, SurfaceTransport& light);

}  // namespace lambent::baker
