// Measures how much of what a group's glossy surfaces reflect depends on each band of the transferred light:
// the squared coefficients of their exit kernels. They weight the errors of coded transfer.
#pragma once

#include <array>

#include "baker/brdf/surface_brdfs.hpp"

namespace lambent::baker {

// Returns for each band the mean of c_lm² over m, over places spread over the glossy triangles, over views
// from 25 to 80 degrees from the normal and over red, green and blue, relative to band 0. Bands from `order`
// on are 0.
std::array<double, 6> kernelPower(const GroupGeometry& geometry, const SurfaceBrdfs& brdfs, int order);

}  // namespace lambent::baker
