// The neighborhood of a group, as the plan and the options want it: of surfaces and of volumes alike.
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include "baker/bake/bake.hpp"
#include "baker/bake/bake_group.hpp"
#include "baker/bake/baked_grids.hpp"
#include "baker/effects/neighborhood/body.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/plan/neighborhoods.hpp"

namespace lambent::baker {

// bounds: of the body, from `origin`, which lies there in the group's frame. rays: from each point. Fills
// `out`, or says in the report's notices why there is none. False if stopped.
bool bakeAround(const Body& body, const Box3& bounds, const glm::vec3& origin, const std::string& name,
                const PlannedNeighborhood& plan, std::size_t rays, const BakeOptions& options,
                Progress& progress, const std::stop_token& stop, BakeReport& report,
                std::optional<BakedNeighborhood>& out);

// A sample of a surface has its rays over a hemisphere, a point in free space over what the body fills, whose
// rim counts.
inline std::size_t raysAroundSurfaces(const BakeOptions& options) {
  return 2 * options.effectiveRays();
}

// The same for a volume that has just been baked. False if stopped.
bool bakeAroundVolume(BakedGroup& volume, const std::string& name, const PlannedNeighborhood& plan,
                      const BakeOptions& options, Progress& progress, const std::stop_token& stop,
                      BakeReport& report);

}  // namespace lambent::baker
