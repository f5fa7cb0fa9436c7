// Gives grid points the values that interpolate best, in place of the values at the points. Linear
// interpolation of a curve lies to one side of it: by δ²/12 on average over a cell, with δ² the second
// difference from point to point. After subtracting that from the points the mean is right, and the RMS error
// of a parabola falls to 0.41 of what it was along each axis. This costs no rays and no bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "baker/effects/neighborhood/grid_placement.hpp"

namespace lambent::baker {

// `values` has `width` values per point. Skips axes along which receivers lie on a layer of points
// (GridPlacement::on_layer), and points that are not `outside` or have a neighbour along the axis that is
// not, since their values are not samples of one curve.
void fitBetweenPoints(const GridPlacement& grid, std::span<const std::uint8_t> outside, std::size_t width,
                      std::span<float> values);

}  // namespace lambent::baker
