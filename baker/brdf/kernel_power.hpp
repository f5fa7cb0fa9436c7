// How much of what glossy surfaces of a group reflect hangs on each band of the transferred light: the
// squared coefficients of their exit kernels. Errors of coded transfer count by it.
#pragma once

#include <array>

#include "baker/brdf/surface_brdfs.hpp"

namespace lambent::baker {

// Per band the mean of c_lm² over m, over places spread over the glossy triangles, over views from 25 to 80
// degrees from the normal and over red, green and blue; relative to band 0. 0 from `order` on.
std::array<double, 6> kernelPower(const GroupGeometry& geometry, const SurfaceBrdfs& brdfs, int order);

}  // namespace lambent::baker
