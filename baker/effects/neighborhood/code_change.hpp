// Codes the change of light on a grid. Its points are the samples of cells; visibility and bounced light are
// two transfers of each cell. Errors are relative to the light near the body (codeTransfer's shown_energy).
// Where little changes such an error may be large against the change, so cells are coded finer until it is
// small against the change too.
#pragma once

#include <vector>

#include "baker/compress/kept_transfer.hpp"
#include "baker/effects/neighborhood/light_change.hpp"

namespace lambent::baker {

struct ChangeCoding {
  double bound = 1e-3;  // RMS over a cell, relative to irradiance without the body; for both parts together
  double of_change = 0.05;      // bound on the error at a point relative to the change there, ...
  double where_changed = 0.02;  // ... for points where the change is above this share of irradiance ...
  double points_within = 0.99;  // ... and for this share of those points
  // Limit that goes before the bounds above, as far as a few attempts reach it: 1.4 MB for 64 x 64 x 8
  // points. Highlights found by few rays are noise that the coder cannot predict.
  double most_bytes = 43.0;  // per point
};

struct CodedChange {
  std::vector<CodedCell> cells;
  double error = 0.0;         // RMS, as `bound`, of the worst cell
  double change_error = 0.0;  // as `of_change`, of the worst cell
};

// `origin` is added to the points for the cells' bounds, and coded points to the running stage. Returns
// nothing if stopped.
std::optional<CodedChange> codeChange(const GridChange& change, const GridPlacement& grid,
                                      const glm::vec3& origin, const ChangeCoding& settings,
                                      CachedCoding& coding, Progress& progress);

}  // namespace lambent::baker
