// Codes the change of light on a grid: its points are samples of cells, visibility and bounced light are two
// transfers of each. Errors are relative to the light near the body (codeTransfer's shown_energy), and as the
// same absolute error is a large one where little changes, cells are coded finer until it is small against
// the change too.
#pragma once

#include <vector>

#include "baker/compress/baked_grids.hpp"
#include "baker/compress/kept_transfer.hpp"
#include "baker/effects/neighborhood/grid_change.hpp"

namespace lambent::baker {

struct ChangeCoding {
  double bound = 1e-3;          // RMS over a cell, of irradiance without the body; of both parts together
  double of_change = 0.05;      // at a point, relative to what changes there,
  double where_changed = 0.02;  // where that is over this share of irradiance
  double points_within = 0.99;  // of those points so many keep `of_change`
  // What wins over all of the above: 1.4 MB for 64 x 64 x 8 points. Highlights of few rays are noise to the
  // coder, which nothing predicts.
  double most_bytes = 43.0;  // of a point
};

struct CodedChange {
  std::vector<CodedCell> cells;
  double error = 0.0;         // RMS, as `bound`; of the worst cell
  double change_error = 0.0;  // what `points_within` of the points with a change keep
};

// origin: added to the points for the cells' bounds. Returns nothing if stopped.
std::optional<CodedChange> codeChange(const GridChange& change, const GridPlacement& grid,
                                      const glm::vec3& origin, const ChangeCoding& settings,
                                      CachedCoding& coding);

}  // namespace lambent::baker
