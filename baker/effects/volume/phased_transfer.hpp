// Computes the transfer of a volume with an anisotropic phase function: the radiance that arrives at its
// samples, in bands. It is a part of bakeVolumeTransfer().
#pragma once

#include "baker/effects/volume/volume_transfer.hpp"

namespace lambent::baker {

// Fills in vectors, visibility and figures of a transfer with more than one band, whose grid, order, bands
// and channels are set. Returns false if stopped.
bool bakePhasedTransfer(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                        VolumeTransfer& out, const BakeContext& context);
// Removes its checkpoints, except those of the solver.
void dropPhasedParts(const BakeContext& context, std::size_t samples);

}  // namespace lambent::baker
