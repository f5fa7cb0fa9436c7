// How near light comes to a group: from how many points the light around it must be sampled, and which lights
// come so near that no sampling tells of them. Looks at where everything is at rest and, where there are
// animations, at 64 times along them all.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baker/import/scene.hpp"
#include "baker/plan/neighborhoods.hpp"
#include "baker/plan/rigid_groups.hpp"

namespace lambent::baker {

inline constexpr std::uint32_t kMostLightProbes = 32;  // that can be asked for

struct LightProbeCount {
  std::uint32_t count = 1;  // 1..kMostLightProbes; 1: a single one for the group
  // Of the group, shared out over its cells by area (at least one each); else of each cell.
  bool of_group = true;
};

struct PlannedLightProbes {
  LightProbeCount count;
  std::string reason;  // one sentence
};

// By half the group's diagonal over the distance of its centre from the nearest light of others (lamps, and
// surfaces that give off light): under 0.05 one (light at infinity), under 0.15 four, under 0.25 eight, under
// 0.5 sixteen, else 32. Bodies of other groups that give off no light ask by the same measure for one or
// four. 32 too where a body of less than half its size comes within its bounds: shadows and reflections of
// it can fall anywhere. Bodies whose neighborhoods (one per group, or none at all) carry what they do to the
// group ask for nothing. One per group of the list.
std::vector<PlannedLightProbes> planLightProbes(const Scene& scene, const std::vector<RigidGroup>& groups,
                                                const std::vector<PlannedNeighborhood>& neighborhoods = {});

// Lamps of others that come within a group's bounds. One sentence each.
std::vector<std::string> lightsInside(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
