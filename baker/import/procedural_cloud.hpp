// A fair-weather cloud made of numbers, for scenes that ship without files: flat below, billows on billows
// above. The same seed gives the same cloud.
#pragma once

#include <cstdint>

#include "baker/import/density_file.hpp"

namespace lambent::baker {

// 96 x 64 x 96 voxels of 1/64, centred at the origin, y up; densities 0..1, empty at all faces.
DensityGrid proceduralCloud(std::uint32_t seed);

}  // namespace lambent::baker
