// The neighborhood of a group, as the plan and the options want it: of surfaces and of volumes alike.
#pragma once

#include <cstddef>
#include <optional>

#include "baker/bake/scene_bake.hpp"
#include "baker/compress/baked_grids.hpp"
#include "baker/effects/neighborhood/body.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

struct Around {
  const SceneBake& bake;
  std::size_t group = 0;   // of the plan
  glm::vec3 origin{0.0f};  // where the body's points lie from, in the group's frame
  std::size_t rays = 0;    // from each point

  const PlannedNeighborhood& plan() const { return bake.plan.neighborhoods[group]; }
};

// Returns the context of the neighborhood. The key of `body` is that of all that the body's answers depend
// on.
BakeContext contextOf(const Around& around, const BakeContext& body);

// Finds what was kept, for `out`, or for the report's notices where there is none. Returns false if it has to
// be baked.
bool findAround(const Around& around, const BakeContext& context, std::optional<BakedNeighborhood>& out);

// Does the same by baking it. bounds: of the body, from `origin`. Returns false if stopped.
bool bakeAround(const Around& around, const Body& body, const Box3& bounds, const BakeContext& context,
                std::optional<BakedNeighborhood>& out);

// A sample of a surface has its rays over a hemisphere, a point in free space over what the body fills, whose
// rim counts.
inline std::size_t raysAroundSurfaces(const BakeOptions& options) {
  return 2 * options.effectiveRays();
}
// A medium has no rims that many rays would have to find, and each ray is a march.
inline std::size_t raysAroundVolumes(const BakeOptions& options) {
  constexpr std::size_t kSampleRaysPerMarch = 4;
  return options.effectiveRays() / kSampleRaysPerMarch;
}

}  // namespace lambent::baker
