// Transfer of a volume whose phase function prefers directions: the radiance that arrives at its samples, in
// bands. Part of bakeVolumeTransfer().
#pragma once

#include "baker/effects/volume/volume_transfer.hpp"

namespace lambent::baker {

// Fills vectors, visibility and figures of a transfer of more than one band; grid, order, bands and channels
// are there. False if stopped.
bool bakePhasedTransfer(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                        VolumeTransfer& out, const BakeContext& context);
// Removes its checkpoints, but for the solver's.
void dropPhasedParts(const BakeContext& context, std::size_t samples);

}  // namespace lambent::baker
