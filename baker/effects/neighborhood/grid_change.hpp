// How a body changes the light at all points of a grid. Points inside the body take values that continue what
// is outside through the surface: twice the value on the surface less the one as far before it as the point
// lies behind it. Between the last point outside and the first one inside, interpolation is then right where
// it meets the surface; darkness does not bleed, and no halo stands around the body. Points deeper inside
// take the mean of their neighbours.
#pragma once

#include <optional>
#include <stop_token>

#include "baker/cache/cached_ranges.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/effects/neighborhood/point_change.hpp"
#include "baker/jobs/progress.hpp"

namespace lambent::baker {

struct GridChange {
  ChangeShape shape;
  std::vector<float> visibility, bounced;  // point after point, as PointChange has them
  std::vector<std::uint8_t> outside;       // per point: 1, or 0 for one whose values were continued
  std::uint64_t rays = 0;                  // from the points, traced in this run; paths come on top
  std::uint64_t rays_kept = 0;

  std::size_t insidePoints() const;
};

// Nothing if stopped. Stage "neighborhood" of `progress`, counting points. The result does not depend on the
// number of threads.
std::optional<GridChange> changeOnGrid(const Body& body, const GridPlacement& grid, const ChangeShape& shape,
                                       std::size_t rays, Progress& progress, const std::stop_token& stop,
                                       const Keep& keep = {});
// What it kept.
void dropChange(const Keep& keep, std::size_t points);

}  // namespace lambent::baker
