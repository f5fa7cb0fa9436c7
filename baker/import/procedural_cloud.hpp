// Makes a fair-weather cloud from a formula, for scenes that ship without files: flat below, with billows on
// billows above. The same seed gives the same cloud.
#pragma once

#include <cstdint>

#include "baker/import/density_file.hpp"

namespace lambent::baker {

// Returns 96 x 64 x 96 voxels of size 1/64, centred at the origin, y up; densities are 0..1, and 0 at all
// faces.
DensityGrid proceduralCloud(std::uint32_t seed);

}  // namespace lambent::baker
