// Computes how a body changes the light at all points of a grid. Points inside the body take values that
// continue the values outside through the surface: twice the value on the surface, less the value as far in
// front of it as the point lies behind it. So interpolation between the last point outside and the first one
// inside is right where it meets the surface: darkness does not bleed, and no halo surrounds the body. Points
// deeper inside take the mean of their neighbours.
#pragma once

#include <optional>

#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/effects/neighborhood/point_change.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

struct GridChange {
  ChangeShape shape;
  std::vector<float> visibility, bounced;  // [point], each as in PointChange
  std::vector<std::uint8_t> outside;       // 1 per point, or 0 if its values were continued
  std::uint64_t rays = 0;  // from the points, traced in this run; rays of paths are not counted
  std::uint64_t rays_kept = 0;

  std::size_t insidePoints() const;
};

// Returns nothing if stopped. The result does not depend on the number of threads.
std::optional<GridChange> changeOnGrid(const Body& body, const GridPlacement& grid, const ChangeShape& shape,
                                       std::size_t rays, const BakeContext& context);
// Removes what changeOnGrid() kept.
void dropChange(const BakeContext& context, std::size_t points);

}  // namespace lambent::baker
