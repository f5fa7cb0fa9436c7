// Points of a grid take what interpolates best, in place of what is at them. Linear interpolation of a curve
// lies to one side of it: by δ²/12 in the mean over a cell, δ² the second difference from point to point.
// With that taken from the points the mean is right, and the RMS error of a parabola falls to 0.41 of what it
// was along each axis. Costs no ray and no byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "baker/effects/neighborhood/grid_placement.hpp"

namespace lambent::baker {

// values: `width` a point. Not along axes on whose layers the receivers stand (GridPlacement::on_layer), nor
// where a point or a neighbour along the axis is not `outside`: their values are no samples of one curve.
void fitBetweenPoints(const GridPlacement& grid, std::span<const std::uint8_t> outside, std::size_t width,
                      std::span<float> values);

}  // namespace lambent::baker
