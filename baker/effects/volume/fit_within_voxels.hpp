// Makes the most of a transfer grid that is too coarse for its medium. Where a free path is shorter than a
// voxel, light changes within the voxel, most of all at the medium's border, where what one sees comes from:
// centres of voxels miss it, and pictures come out too dark. So light is looked at eight places a voxel once
// more, by an eighth of the rays each, turned from place to place: what comes in from outside, and one
// scattering of what the solver has found. Then samples become what interpolates best to that, weighted by
// what of it goes out: density times the mean transmittance to the outside (grid_fit.hpp).
#pragma once

#include "baker/effects/volume/occluders.hpp"
#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/effects/volume/volume_transfer.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// Changes the vectors of `out`, one output each. rows: none where single scattering is all. Voxels in which
// no place is over a quarter of a free path thick are not looked at. Returns false if stopped.
bool fitWithinVoxels(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                     const ScatterRows* rows, VolumeTransfer& out, const BakeContext& context);
// Removes what it kept.
void dropWithinVoxels(const BakeContext& context, const DensityField& density, const TransferGrid& grid);

}  // namespace lambent::baker
