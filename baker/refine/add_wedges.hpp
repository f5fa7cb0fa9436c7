// Values apart (fans.hpp) in the meshes of a scene: of glossy surfaces, whose lobes show visibility near the
// horizon that diffuse ones average away.
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

// By what the refiners measured last, of groups and geometries as they are now, over all meshes where it
// gains most: until the relative error that is left is `bound`, or `most` fans were added. How many were;
// nothing if stopped.
std::optional<std::size_t> addWedges(const std::vector<RigidGroup>& groups,
                                     const std::vector<GroupGeometry>& geometries,
                                     const std::vector<GroupRefiner>& refiners, double bound,
                                     std::size_t most, std::vector<std::vector<bundle::MeshData>>& meshes,
                                     const std::stop_token& stop);

}  // namespace lambent::baker
