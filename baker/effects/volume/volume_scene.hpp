// A medium, its grid and the surfaces around it, as everything that looks through the volume reads them.
#pragma once

#include "baker/effects/volume/density_field.hpp"
#include "baker/effects/volume/occluders.hpp"
#include "baker/effects/volume/transfer_grid.hpp"

namespace lambent::baker {

// All of it outlives whoever holds this.
struct VolumeScene {
  const DensityField& density;
  const TransferGrid& grid;
  const Occluders& occluders;
};

}  // namespace lambent::baker
