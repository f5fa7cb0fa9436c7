// Collects the edges to be split. An edge is identified by where its ends lie in the group, so that all faces
// that meet there agree. The marks are then carried to the meshes, each of which may be drawn at several
// places.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/ray_scene.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Counts how often each primitive is drawn. Every copy has samples of its own, so that what a split costs
// grows with the copies of the mesh.

using CopiesOfMeshes = std::vector<std::vector<std::size_t>>;  // [mesh][primitive]

// Back sides are no copies. What is not drawn counts once.
CopiesOfMeshes copiesOf(const std::vector<RigidGroup>& groups,
                        const std::vector<std::vector<bundle::MeshData>>& meshes);

// Returns the vertices of all copies.
std::size_t countDrawn(const CopiesOfMeshes& copies,
                       const std::vector<std::vector<bundle::MeshData>>& meshes);

// Finds where another surface cuts an edge of a face. Such a face is lit on one side of the cut and dark on
// the other. No vertex may mix both, and none should lie in the cut: each side gets a vertex of its own, a
// little before it.

struct FaceEdge {
  std::uint32_t a, b, triangle;  // two vertices, and the triangle to which the edge belongs
};

class FaceCuts {
 public:
  // `scene` is what is seen by `rays`, which outlive this; vertices keep a distance from a cut that is
  // relative to `extent`.
  FaceCuts(const GroupGeometry& scene, const RayScene& rays, float extent);

  // Returns for each edge the share of the way from a to b at which it is split because another surface cuts
  // it, or 0, also if the way is longer than `longest`.
  std::vector<float> sharesOf(const GroupGeometry& geometry, std::span<const FaceEdge> edges,
                              float longest) const;

 private:
  const RayScene& rays_;
  std::vector<glm::vec3> normals_;  // of the scene's triangles; 0 for those without area
  float before_;                    // the distance of a vertex from a cut
};

class MarkedEdges {
 public:
  // geometries[g] is that of groups[g], built from the current `meshes`.
  MarkedEdges(const std::vector<RigidGroup>& groups, const std::vector<GroupGeometry>& geometries,
              const std::vector<std::vector<bundle::MeshData>>& meshes);

  // Marks the edge between two vertices of a group's geometry, to be split in half. Returns about how many
  // vertices that adds to what is drawn, none if the same edge is marked where the mesh is drawn elsewhere;
  // or nothing if it was marked before.
  std::optional<std::size_t> mark(std::size_t group, std::uint32_t a, std::uint32_t b);
  // Has a marked edge split at this share of the way from `a` to `b`, which is rounded.
  void splitAt(std::size_t group, std::uint32_t a, std::uint32_t b, float share);

  // Splits the marked edges in all meshes, and with them the same edges where a mesh is drawn elsewhere.
  void split(std::vector<std::vector<bundle::MeshData>>& meshes);

 private:
  // Shares are those of the way from the lower place or vertex of a pair.
  using Shares = std::unordered_map<std::uint64_t, float>;

  std::size_t added(std::size_t group, std::uint32_t a, std::uint32_t b);
  std::uint64_t placesOf(std::size_t group, std::uint32_t a, std::uint32_t b) const;
  bool spread();

  const std::vector<RigidGroup>& groups_;
  const std::vector<GroupGeometry>& geometries_;
  const std::vector<std::vector<bundle::MeshData>>& meshes_;
  std::vector<std::vector<std::uint32_t>> place_;  // place number of each vertex of each group
  std::vector<Shares> in_group_;                   // by pairs of places
  std::vector<std::vector<Shares>> in_mesh_;       // [mesh][primitive] by pairs of vertices
  CopiesOfMeshes copies_;
  std::vector<std::vector<std::unordered_set<std::uint64_t>>> counted_;  // [mesh][primitive], pairs likewise
};

}  // namespace lambent::baker
