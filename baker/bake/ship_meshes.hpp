// Bakes what ships: meshes are split, encoded by Draco on the lattice of their group and decoded again before
// anything is computed on them.
#pragma once

#include <vector>

#include "baker/compress/draco_encode.hpp"
#include "baker/import/scene.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/plan/rigid_groups.hpp"

namespace lambent::baker {

// Chooses the lattices on which the positions of primitives are coded (compress/draco_encode.hpp). A rigid
// group has one lattice, whose step follows its size; so vertices that its primitives have in common stay so.
// A primitive whose details that step would bend, as a ball on a ground of 10 km, gets a finer one, of which
// the other is a part: all steps are powers of two.

using Meshes = std::vector<std::vector<bundle::MeshData>>;  // [mesh][primitive]
using LatticeSteps = std::vector<std::vector<float>>;       // [mesh][primitive], mesh units

// Returns the greatest length of a mesh's unit axes in the group's frame.
float scaleOf(const glm::mat4& group_from_mesh);

LatticeSteps latticeSteps(const Scene& scene, const std::vector<RigidGroup>& groups);

struct ShippedMeshes {
  std::vector<std::vector<std::vector<std::byte>>> draco;        // [mesh][primitive]
  std::vector<std::vector<bundle::DracoAttributes>> attributes;  // [mesh][primitive]
  std::vector<std::vector<bundle::MeshData>> decoded;            // [mesh][primitive]
};

// Returns the scene's meshes with edges longer than max_edge_m (metres in the group's frame; 0: no limit)
// split. Errors: too many triangles.
Result<Meshes> splitMeshes(const Scene& scene, const std::vector<RigidGroup>& groups, float max_edge_m);

// Encodes and decodes the meshes. A mesh that was encoded before on the same lattice is taken from the cache.
// Errors: a mesh that cannot be encoded, "stopped".
Result<ShippedMeshes> shipMeshes(const Scene& scene, const std::vector<RigidGroup>& groups, Meshes meshes,
                                 const BakeContext& context);

}  // namespace lambent::baker
