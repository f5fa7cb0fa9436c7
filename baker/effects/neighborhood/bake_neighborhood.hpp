// Neighborhood transfer of one body, from where its grid stands to codes.
#pragma once

#include <optional>

#include "baker/cache/bytes.hpp"
#include "baker/compress/baked_grids.hpp"
#include "baker/effects/neighborhood/body.hpp"
#include "baker/effects/neighborhood/code_change.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/plan/facing_area.hpp"

namespace lambent::baker {

struct NeighborhoodSettings {
  PlacementWish placement;  // as the body's points: from `origin`
  FacingArea facing{};      // of the receivers; none: anywhere
  glm::vec3 origin{0.0f};   // of those points in the group's frame
  bool matrices = false;  // as many outputs as the light has bands, for receivers with transfer of their own
  std::size_t rays = 2048;  // from each point towards the body
  // Points hold what interpolates best to the change between them (fit_between_points.hpp), in place of the
  // change at them.
  bool fit_between_points = false;
  ChangeCoding coding;
};

struct NeighborhoodFigures {
  glm::uvec3 size{0};
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // group frame
  std::size_t inside_points = 0;                 // that were continued from outside
  std::uint64_t rays = 0;                        // traced in this run
  std::uint64_t rays_kept = 0;                   // that results of earlier runs stand for
  double error = 0.0, change_error = 0.0;        // as CodedChange
};

struct BakedAround {
  std::optional<BakedNeighborhood> grid;  // none: no receiver comes within reach, or the body has no size
  NeighborhoodFigures figures;
};

void write(const BakedAround& around, ByteWriter& out);
bool read(ByteReader& in, BakedAround& around);

// Order of the light up to 6. Returns nothing if stopped. The result does not depend on the number of
// threads. The key of the context is that of body and settings; the result is kept under it.
std::optional<BakedAround> bakeNeighborhood(const Body& body, const NeighborhoodSettings& settings,
                                            const BakeContext& context);

}  // namespace lambent::baker
