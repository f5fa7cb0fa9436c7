// Fits a transfer grid that is too coarse for its medium. Where a free path is shorter than a voxel, light
// changes within the voxel, most of all at the border of the medium, which is the part that one sees; voxel
// centres miss that, and pictures come out too dark. So light is computed at eight more places per voxel,
// with an eighth of the rays each, rotated from place to place: light that comes in from outside, and one
// scattering of the solver's result. Samples then become the values that interpolate best to it, weighted by
// how much of it leaves the medium: density times the mean transmittance to the outside (grid_fit.hpp).
#pragma once

#include "baker/effects/volume/occluders.hpp"
#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/effects/volume/volume_transfer.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// Changes the vectors of `out`, which must have one output. `rows` is null if there is only single
// scattering. Voxels whose optical depth is at most 0.25 at all of their places are left out. Returns false
// if stopped.
bool fitWithinVoxels(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                     const ScatterRows* rows, VolumeTransfer& out, const BakeContext& context);
// Removes what fitWithinVoxels() kept.
void dropWithinVoxels(const BakeContext& context, const DensityField& density, const TransferGrid& grid);

}  // namespace lambent::baker
