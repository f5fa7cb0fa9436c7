// Gives vertices of glossy surfaces several values (wedges.hpp), because glossy lobes show visibility near
// the horizon that diffuse surfaces average away.
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <vector>

#include "baker/plan/rigid_groups.hpp"
#include "baker/refine/group_refiner.hpp"
#include "baker/transport/group_geometry.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Groups and geometries as they are now, and what the refiners measured last; one entry per group. Groups
// that were not measured are left as they are.
struct MeasuredGroups {
  const std::vector<RigidGroup>& groups;
  const std::vector<GroupGeometry>& geometries;
  const std::vector<GroupRefiner>& refiners;
};

struct WedgeLimits {
  double bound;      // of the relative error that is left
  std::size_t most;  // fans that may be added
};

// Adds fans over all meshes where it gains most, until one of the limits is reached. Returns how many were
// added, or nothing if stopped.
std::optional<std::size_t> addWedges(const MeasuredGroups& measured, const WedgeLimits& limits,
                                     std::vector<std::vector<bundle::MeshData>>& meshes,
                                     const std::stop_token& stop);

}  // namespace lambent::baker
