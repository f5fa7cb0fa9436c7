// Counts how often each primitive is drawn. Every copy has samples of its own, so that what a split costs
// grows with the copies of the mesh.
#pragma once

#include <cstddef>
#include <vector>

#include "baker/plan/rigid_groups.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

using CopiesOfMeshes = std::vector<std::vector<std::size_t>>;  // [mesh][primitive]

// Back sides are no copies. What is not drawn counts once.
CopiesOfMeshes copiesOf(const std::vector<RigidGroup>& groups,
                        const std::vector<std::vector<bundle::MeshData>>& meshes);

// Returns the vertices of all copies.
std::size_t countDrawn(const CopiesOfMeshes& copies,
                       const std::vector<std::vector<bundle::MeshData>>& meshes);

}  // namespace lambent::baker
