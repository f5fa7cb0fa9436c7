// Holds a medium, its grid and the surfaces around it, for everything that traces rays through the volume.
#pragma once

#include "baker/effects/volume/density_field.hpp"
#include "baker/effects/volume/occluders.hpp"
#include "baker/effects/volume/transfer_grid.hpp"

namespace lambent::baker {

// The referenced objects must outlive every holder of a VolumeScene.
struct VolumeScene {
  const DensityField& density;
  const TransferGrid& grid;
  const Occluders& occluders;
};

}  // namespace lambent::baker
