// Follows one rigid group through all rounds of refinement: it finds what light reaches the group's vertices
// and points inside its triangles, how wrong interpolation over triangles is where eyes see it, and which
// edges are to be split.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"
#include "baker/importance/importance.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "baker/refine/probed_points.hpp"
#include "baker/refine/refine.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Collects the edges to be split. An edge is identified by where its ends lie in the group, so that all faces
// that meet there agree. The marks are then carried to the meshes, each of which may be drawn at several
// places.

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

// Returns for each edge the share of the way from a to b at which it is split because another surface cuts
// it, or 0, also if the way is longer than `longest`. `scene` is what is seen by `rays`; vertices keep a
// distance from a cut that is relative to `extent`.
std::vector<float> cutShares(const GroupGeometry& scene, const RayScene& rays, float extent,
                             const GroupGeometry& geometry, std::span<const FaceEdge> edges, float longest);

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

// Few rays say where something may be wrong. Their noise is as large as small errors are: the triangles that
// it makes look worst are split and those that it makes look right stay, so that in the end the figure is
// under the bound and the error is not. Many rays therefore probe again before anything is split. Glossy
// surfaces are not probed again: their pictures gain nothing from it, and their probes cost most.
struct RefineProbes {
  const ShadowProbe &few, &many;
};

class GroupRefiner {
 public:
  // The probes outlive this. Glossy surfaces are refined `with_glossy` alone.
  GroupRefiner(const RefineProbes& probes, bool with_glossy);
  GroupRefiner(GroupRefiner&&) noexcept;
  ~GroupRefiner();

  // Everything that `from` refers to outlives this. The geometry is that before any split: rays are traced
  // against it in all rounds. Errors: no memory for the hierarchy, images that cannot be decoded.
  Result<void> prepare(const RefineScene& from, std::size_t group, const GroupGeometry& geometry);

  // Measures the relative error of every triangle that eyes see, by many rays where it could matter for
  // `bound`. Errors: no memory for the hierarchy. False when stopped.
  Result<bool> measure(const GroupGeometry& geometry, double bound, const BakeContext& context);

  bool measured() const { return whole_ != nullptr; }
  // Returns the RMS of what interpolation gets wrong at a point, relative to the light that arrives there, in
  // all but the worst 5 % of the regions that eyes see.
  double relativeError() const;
  std::uint64_t raysTraced() const { return few_.raysTraced() + many_.raysTraced(); }
  std::uint64_t raysKept() const { return few_.raysKept() + many_.raysKept(); }

  // Marks edges of the worst triangles in regions beyond the bound, until what remains there is within it or
  // `room` new vertices are spent. Returns how many edges were marked.
  std::size_t markWorst(std::size_t group, const GroupGeometry& geometry, double bound, std::size_t& room,
                        MarkedEdges& edges);

  // Marks edges that another surface cuts between an end in the dark and one in the light, as far as `room`
  // goes, whatever errors were measured: the inner points of such faces may all lie inside that surface.
  // Returns how many edges were marked, or nothing when stopped.
  std::optional<std::size_t> markLeaks(std::size_t group, const GroupGeometry& geometry, std::size_t& room,
                                       MarkedEdges& edges, const BakeContext& context);

 private:
  struct Whole;      // the group before any split
  struct SeenPlace;  // a point of it that an eye sees
  struct Inner {     // a point inside a triangle
    std::uint32_t triangle = 0, region = 0;
    glm::vec3 weights{0.0f};  // of the corners
    FacePoint point;
    float share = 0.0f;  // of all pictures
  };
  // The inner points [first, last) of a triangle in one region, and what rays say of them, times their share.
  struct Part {
    std::uint32_t triangle = 0, region = 0;
    std::size_t first = 0, last = 0;
    double square_error = 0.0;  // without bias from noise, so it may be below 0
    double with_noise = 0.0;    // the square that all rays together show, which noise makes larger
    double seen = 0.0;          // the share of the points that can be seen
  };

  // Places inner points in the triangles that eyes see, whose vertices pictures show, which they do not where
  // there are texels, and whose splits would show.
  Result<void> placeInner(const GroupGeometry& geometry);
  // Adds points of a triangle that cover it evenly.
  void addEvenly(const GroupGeometry& geometry, std::uint32_t triangle, int along);
  // Returns what is seen per square metre at a point.
  float seenAt(const FacePoint& point);
  // Fills in what rays say of the parts of the triangles listed. Returns false when stopped.
  bool measureBy(ProbedPoints& points, const GroupGeometry& geometry, const SampleSet& samples,
                 std::span<const std::uint32_t> triangles, const BakeContext& context);
  // Returns the triangles of all parts, in ascending order.
  std::vector<std::uint32_t> seenTriangles() const;
  // Returns the triangles that have nearly all of the square error of their region, whatever noise hides, but
  // for those that few rays are sure of; in ascending order.
  std::vector<std::uint32_t> trianglesThatMatter(double bound) const;
  struct RegionSums {
    std::vector<double> square_error, seen;
  };
  RegionSums sumRegions() const;

  ProbedPoints few_, many_;
  bool with_glossy_;
  std::unique_ptr<Whole> whole_;
  std::unordered_map<VertexKey, float, VertexKeyHash> seen_at_;  // of the points of all rounds
  bool chosen_ = false;       // triangles were marked, so that few rays are no longer right on average
  std::vector<Inner> inner_;  // by triangle, and then by region
  std::vector<Part> parts_;   // in the same order
};

}  // namespace lambent::baker
