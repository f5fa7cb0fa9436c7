// Computes how bodies change the light around them, for groups that baker/plan/neighborhoods.hpp chooses.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "baker/cache/key.hpp"
#include "baker/compress/kept_transfer.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/effects/neighborhood/light_change.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/plan/neighborhoods.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

// Codes the change of light on a grid. Its points are the samples of cells; visibility and bounced light are
// two transfers of each cell. Errors are relative to the light near the body (codeTransfer's shown_energy).
// Where little changes such an error may be large against the change, so cells are coded finer until it is
// small against the change too.

struct ChangeCoding {
  double bound = 1e-3;  // RMS over a cell, relative to irradiance without the body; for both parts together
  // Limit that goes before the bounds above, as far as a few attempts reach it: 1.4 MB for 64 x 64 x 8
  // points. Highlights found by few rays are noise that the coder cannot predict.
  double most_bytes = 43.0;  // per point
};

struct CodedChange {
  std::vector<CodedCell> cells;
  double error = 0.0;         // RMS, as `bound`, of the worst cell
  double change_error = 0.0;  // relative to the change at most points, of the worst cell
};

// `origin` is added to the points for the cells' bounds, and coded points to the running stage. Returns
// nothing if stopped.
std::optional<CodedChange> codeChange(const GridChange& change, const GridPlacement& grid,
                                      const glm::vec3& origin, const ChangeCoding& settings,
                                      CachedCoding& coding, Progress& progress);

// Measures what receivers see of a change, given how their surfaces face; this decides how far a grid
// reaches. A floor loses little light to a body that stands on it far away, however much of its sky the body
// fills; ChangeMeter, which takes all normals, would make the grid as long as the floor.

class ReceiverMeter {
 public:
  // If `facing` has no area, receivers may face anywhere.
  ReceiverMeter(const ChangeShape& shape, const FacingArea& facing);

  // Does what ChangeMeter::measure does, over the normals of the receivers and for their cosine in three
  // bands. May be called from any thread.
  double measure(std::span<const float> visibility, std::span<const float> bounced) const;

 private:
  static constexpr std::size_t kOutputs = 9;
  ChangeShape shape_;
  sh::GauntTable gaunt_;
  std::vector<double> light_power_;                          // one per column
  std::array<std::array<double, kOutputs>, kOutputs> seen_;  // mean over normals of A_i y_i A_j y_j
  double light_ = 0.0;
};

// Bakes the neighborhood transfer of one body, from the placement of its grid to codes.

struct NeighborhoodSettings {
  PlacementWish placement;  // relative to `origin`, like the body's points
  FacingArea facing{};      // of the receivers; all 0: they may face anywhere
  glm::vec3 origin{0.0f};   // of the body's points, in the group's frame
  // If true, there are as many outputs as the light has bands, for receivers with transfer of their own.
  bool matrices = false;
  std::size_t rays = 2048;  // from each point towards the body
  // If true, points hold the values that interpolate best to the change between them
  // (grid_placement.hpp), in place of the change at the points.
  bool fit_between_points = false;
  ChangeCoding coding;
};

struct NeighborhoodFigures {
  std::size_t inside_points = 0;           // points inside the body, continued from outside
  std::uint64_t rays = 0;                  // traced in this run
  std::uint64_t rays_kept = 0;             // rays that results of earlier runs saved
  double error = 0.0, change_error = 0.0;  // as in CodedChange
};

struct BakedAround {
  std::optional<BakedNeighborhood> grid;  // empty if no receiver comes within reach, or the body has no size
  NeighborhoodFigures figures;
};

template <>
inline constexpr auto kKeptMembers<NeighborhoodFigures> = std::tuple(&NeighborhoodFigures::inside_points,
                                                                     &NeighborhoodFigures::rays,
                                                                     &NeighborhoodFigures::rays_kept,
                                                                     &NeighborhoodFigures::error,
                                                                     &NeighborhoodFigures::change_error);
template <>
inline constexpr auto kKeptMembers<BakedAround> = std::tuple(&BakedAround::grid, &BakedAround::figures);

// Looks for a result in the cache.
bool findNeighborhood(const BakeContext& context, BakedAround& around);

// The light has up to 6 bands. Returns nothing if stopped. The result does not depend on the number of
// threads. The key of the context covers body and settings; the result is kept under it.
std::optional<BakedAround> bakeNeighborhood(const Body& body, const NeighborhoodSettings& settings,
                                            const BakeContext& context);

}  // namespace lambent::baker
