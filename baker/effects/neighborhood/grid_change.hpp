// How a body changes the light at all points of a grid. Points inside the body take values that continue what
// is outside through the surface: twice the value on the surface less the one as far before it as the point
// lies behind it. Between the last point outside and the first one inside, interpolation is then right where
// it meets the surface; darkness does not bleed, and no halo stands around the body. Points deeper inside
// take the mean of their neighbours.
#pragma once

#include <optional>

#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/effects/neighborhood/point_change.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

struct GridChange {
  ChangeShape shape;
  std::vector<float> visibility, bounced;  // point after point, as PointChange has them
  std::vector<std::uint8_t> outside;       // per point: 1, or 0 for one whose values were continued
  std::uint64_t rays = 0;                  // from the points, traced in this run; paths come on top
  std::uint64_t rays_kept = 0;

  std::size_t insidePoints() const;
};

// Returns nothing if stopped. The result does not depend on the number of threads.
std::optional<GridChange> changeOnGrid(const Body& body, const GridPlacement& grid, const ChangeShape& shape,
                                       std::size_t rays, const BakeContext& context);
// Removes what it kept.
void dropChange(const BakeContext& context, std::size_t points);

}  // namespace lambent::baker
