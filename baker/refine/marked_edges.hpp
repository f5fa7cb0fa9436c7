// Collects the edges to be split. An edge is identified by where its ends lie in the group, so that all faces
// that meet there agree. The marks are then carried to the meshes, each of which may be drawn at several
// places.
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
  // geometries[g] is that of groups[g], built from the current `meshes`.
  MarkedEdges(const std::vector<RigidGroup>& groups, const std::vector<GroupGeometry>& geometries,
              const std::vector<std::vector<bundle::MeshData>>& meshes);

  // Marks the edge between two vertices of a group's geometry. Returns true if it was not marked before.
  bool mark(std::size_t group, std::uint32_t a, std::uint32_t b);

  // Splits the marked edges in all meshes, and with them the same edges where a mesh is drawn elsewhere.
  void split(std::vector<std::vector<bundle::MeshData>>& meshes);

 private:
  std::uint64_t placesOf(std::size_t group, std::uint32_t a, std::uint32_t b) const;
  bool spread();

  const std::vector<RigidGroup>& groups_;
  const std::vector<GroupGeometry>& geometries_;
  const std::vector<std::vector<bundle::MeshData>>& meshes_;
  std::vector<std::vector<std::uint32_t>> place_;            // place number of each vertex of each group
  std::vector<std::unordered_set<std::uint64_t>> in_group_;  // pairs of places
  std::vector<std::vector<std::unordered_set<std::uint64_t>>>
      in_mesh_;  // [mesh][primitive] pairs of vertices
};

}  // namespace lambent::baker
