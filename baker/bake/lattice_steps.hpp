// Chooses the lattices on which the positions of primitives are coded (compress/draco_encode.hpp). A rigid
// group has one lattice, whose step follows its size; so vertices that its primitives have in common stay so.
// A primitive whose details that step would bend, as a ball on a ground of 10 km, gets a finer one, of which
// the other is a part: all steps are powers of two.
#pragma once

#include <vector>

#include "baker/import/scene.hpp"
#include "baker/plan/rigid_groups.hpp"

namespace lambent::baker {

using Meshes = std::vector<std::vector<bundle::MeshData>>;  // [mesh][primitive]
using LatticeSteps = std::vector<std::vector<float>>;       // [mesh][primitive], mesh units

// Returns the greatest length of a mesh's unit axes in the group's frame.
float scaleOf(const glm::mat4& group_from_mesh);

LatticeSteps latticeSteps(const Scene& scene, const std::vector<RigidGroup>& groups);

// Moves vertices that a primitive shares with one on a coarser lattice to places on that, so that no seam
// opens between them.
void closeSeams(const std::vector<RigidGroup>& groups, const LatticeSteps& steps, Meshes& meshes);

}  // namespace lambent::baker
