// Bakes the neighborhood of a group, of surfaces or of a volume, as the plan and the options ask for it.
#pragma once

#include <cstddef>

#include "baker/bake/bake_group.hpp"
#include "baker/bake/group_scene.hpp"
#include "baker/compress/kept_transfer.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/effects/neighborhood/light_change.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

struct Around {
  const SceneBake& bake;
  std::size_t group = 0;   // index in the plan
  glm::vec3 origin{0.0f};  // of the body's points, in the group's frame
  std::size_t rays = 0;    // from each grid point

  const PlannedNeighborhood& plan() const { return bake.plan.neighborhoods[group]; }
};

// Returns the context of the neighborhood. The key of `body` must cover everything that the body's answers
// depend on.
BakeContext contextOf(const Around& around, const BakeContext& body);

// Looks for a result in the cache. If there is one, sets the neighborhood of `out` and reports it, or adds a
// notice if the result is that there is none. Returns false if it has to be baked.
bool findAround(const Around& around, const BakeContext& context, BakedGroup& out);

// Does the same by baking it. `bounds` are those of the body, relative to `origin`. Returns false if stopped.
bool bakeAround(const Around& around, const Body& body, const Box3& bounds, const BakeContext& context,
                BakedGroup& out);

// Returns the rays per grid point around surfaces. A sample of a surface spreads its rays over a hemisphere;
// a point in free space spreads them over the directions that the body fills, and the body's rim counts.
inline std::size_t raysAroundSurfaces(const BakeOptions& options) {
  return 2 * options.effectiveRays();
}
// Returns the rays per grid point around a volume. A medium has no sharp rim to find, and each ray is
// marched.
inline std::size_t raysAroundVolumes(const BakeOptions& options) {
  constexpr std::size_t kSampleRaysPerMarch = 4;
  return options.effectiveRays() / kSampleRaysPerMarch;
}

}  // namespace lambent::baker
