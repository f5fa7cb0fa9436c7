// "Bake what ships": meshes are refined, coded by Draco on one lattice per group and decoded again before
// anything is computed on them.
#pragma once

#include <vector>

#include "baker/compress/draco_encode.hpp"
#include "baker/import/scene.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/plan/rigid_groups.hpp"

namespace lambent::baker {

struct ShippedMeshes {
  std::vector<std::vector<std::vector<std::byte>>> draco;        // [mesh][primitive]
  std::vector<std::vector<bundle::DracoAttributes>> attributes;  // [mesh][primitive]
  std::vector<std::vector<bundle::MeshData>> decoded;            // [mesh][primitive]
};

using Meshes = std::vector<std::vector<bundle::MeshData>>;  // [mesh][primitive]

// The scene's meshes; edges longer than max_edge_m (in the group's metres) are split, 0: none. Error: too
// many triangles.
Result<Meshes> splitMeshes(const Scene& scene, const std::vector<RigidGroup>& groups, float max_edge_m);

// A mesh that was coded before on the same lattice is found in the cache.
Result<ShippedMeshes> shipMeshes(const Scene& scene, const std::vector<RigidGroup>& groups,
                                 const Meshes& meshes, const BakeContext& context);

}  // namespace lambent::baker
