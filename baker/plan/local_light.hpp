// Decides how many light probes each group needs, from how near light comes to it, and lists the lamps that
// come within a group, where light probes cannot describe their light. Both look at the scene at rest and, if
// it has animations, at 64 times along them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baker/import/scene.hpp"
#include "baker/plan/neighborhoods.hpp"
#include "baker/plan/rigid_groups.hpp"

namespace lambent::baker {

inline constexpr std::uint32_t kMostLightProbes = 32;  // the largest count that can be asked for

struct LightProbeCount {
  std::uint32_t count = 1;  // 1..kMostLightProbes; 1 means a single one for the group
  // True: the count is for the whole group, and its cells share it by area (at least one each). False: the
  // count is for each cell.
  bool of_group = true;
};

struct PlannedLightProbes {
  LightProbeCount count;
  std::string reason;  // one sentence
};

// Returns one entry per group of the list. The count follows the ratio of half the group's diagonal to the
// distance from its centre to the nearest light of another group (lamps and surfaces that give off light):
// one light probe below 0.05 (light at infinity), four below 0.15, eight below 0.25, sixteen below 0.5, else
// 32. Bodies of other groups that give off no light ask for one or four by the same ratio. A body of less
// than half the group's size that comes within its bounds asks for 32, since its shadows and reflections can
// fall anywhere. A body whose neighborhood carries its effect on the group asks for nothing. `neighborhoods`
// holds one entry per group, or is empty.
std::vector<PlannedLightProbes> planLightProbes(const Scene& scene, const std::vector<RigidGroup>& groups,
                                                const std::vector<PlannedNeighborhood>& neighborhoods = {});

// Returns one sentence for each lamp of another group that comes within a group's bounds.
std::vector<std::string> lightsInside(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
