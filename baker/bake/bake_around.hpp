// The neighborhood of a group, as the plan and the options want it: of surfaces and of volumes alike.
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include "baker/bake/bake.hpp"
#include "baker/cache/cached_ranges.hpp"
#include "baker/compress/baked_grids.hpp"
#include "baker/effects/neighborhood/body.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/plan/neighborhoods.hpp"

namespace lambent::baker {

struct Around {
  const std::string& name;  // of the group
  const PlannedNeighborhood& plan;
  glm::vec3 origin{0.0f};  // where the body's points lie from, in the group's frame
  std::size_t rays = 0;    // from each point
  const BakeOptions& options;
};

// body: of all that the body's answers depend on.
Keep keepOf(const Around& around, Cache* cache, const Key& body);

// What was kept, into `out`, or into the report's notices where there is none. False: it has to be baked.
bool findAround(const Around& around, const Keep& keep, BakeReport& report,
                std::optional<BakedNeighborhood>& out);

// The same by baking it. bounds: of the body, from `origin`. False if stopped.
bool bakeAround(const Around& around, const Body& body, const Box3& bounds, Progress& progress,
                const std::stop_token& stop, const Keep& keep, BakeReport& report,
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
