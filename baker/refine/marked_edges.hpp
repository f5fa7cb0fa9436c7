// Which edges are to be split, told by where their ends lie in the group, so that all faces that meet there
// agree; and what that means for the meshes, of which one may be drawn at several places.
#pragma once

#include <cstdint>
#include <unordered_set>
#include <utility>
#include <vector>

#include "baker/import/scene.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

class MarkedEdges {
 public:
  // geometries[g]: of groups[g], built from `meshes` as they are now.
  MarkedEdges(const std::vector<RigidGroup>& groups, const std::vector<GroupGeometry>& geometries,
              const std::vector<std::vector<bundle::MeshData>>& meshes);

  // Between two vertices of a group's geometry. True if it was not marked before.
  bool mark(std::size_t group, std::uint32_t a, std::uint32_t b);

  // Halves the marked edges, and those that share a mesh with them, in all meshes.
  void split(std::vector<std::vector<bundle::MeshData>>& meshes);

 private:
  std::uint64_t placesOf(std::size_t group, std::uint32_t a, std::uint32_t b) const;
  bool spread();

  const std::vector<RigidGroup>& groups_;
  const std::vector<GroupGeometry>& geometries_;
  const std::vector<std::vector<bundle::MeshData>>& meshes_;
  std::vector<std::vector<std::uint32_t>> place_;            // of each vertex of each group
  std::vector<std::unordered_set<std::uint64_t>> in_group_;  // pairs of places
  std::vector<std::vector<std::unordered_set<std::uint64_t>>>
      in_mesh_;  // [mesh][primitive] pairs of vertices
};

}  // namespace lambent::baker
