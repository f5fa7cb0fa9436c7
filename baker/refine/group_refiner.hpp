// Follows one rigid group through all rounds of refinement: it finds what light reaches the group's vertices
// and points inside its triangles, how wrong interpolation over triangles is where eyes see it, and which
// edges are to be split.
#pragma once

#include <algorithm>
#include <array>
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
#include "baker/refine/refine.hpp"
#include "baker/trace/emitters.hpp"
#include "baker/transport/geometry_key.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Finds what is hidden from a surface point, as one bit for each of many directions, and how wrong it is to
// show a mixture of other points' bits instead: the transfer that interpolation over triangles gets wrong.
// All points use the same directions, so that neighbours which see the same have no difference.

// HiddenFrom holds what one point sees, and its weight in a mixture.
struct HiddenFrom {
  std::span<const std::uint16_t> masks;  // ShadowProbe::packets() values
  glm::vec3 normal{0.0f};                // unit shading normal
  float share = 1.0f;
};

class ShadowProbe {
 public:
  // `rays` go over the whole sphere; their number is rounded up to whole packets in each of its quarters.
  explicit ShadowProbe(std::size_t rays);

  std::size_t rays() const { return directions_.size(); }
  std::size_t packets() const { return directions_.packets(); }

  // Fills in which directions are hidden. For a diffuse sample, directions below its faces are hidden too;
  // for a glossy or normal-mapped one, directions below the normal are mirrored, as in its transfer. Returns
  // false if the point stands where it cannot be seen.
  bool look(const RayScene& scene, std::span<const SampleOrigin> origins, const glm::vec3& normal,
            SampleKind kind, std::span<std::uint16_t> masks) const;

  // Returns how the mixture of `corners` differs from `truth`, as seen by each half of the directions. The
  // product of both halves (squareError) is the mean square error over real lights of showing one instead of
  // the other, relative to the light of an open point: of the irradiance, or of what glossy surfaces reflect.
  // It has no bias from too few rays, and may therefore come out a little below 0.
  static constexpr std::size_t kMostValues = 81;  // diffuse samples use fewer, the rest is 0
  using Difference = std::array<std::array<float, kMostValues>, 2>;
  Difference difference(std::span<const HiddenFrom, 3> corners, const HiddenFrom& truth,
                        SampleKind kind) const;
  // Returns what arrives at a point in the same way: its square is the mean square of the light there.
  Difference arriving(const HiddenFrom& point, SampleKind kind) const;
  static double squareError(const Difference& difference);
  // Returns the irradiance by uniform light, relative to that of an open point, 0..1.
  float openShare(const HiddenFrom& point) const;

 private:
  // Returns harmonics of a direction, scaled so that the square of their sum over what is wrongly hidden is
  // an error.
  std::span<const float> row(std::size_t direction, bool plain) const;

  // Two halves with patterns of their own, because errors are products of what each half shows.
  DirectionTable directions_;
  InsideTestTables inside_test_;
  std::vector<float> irradiance_, visibility_;
};

// Estimates the light that surfaces of a group send to its points: that of its lamps, each as bright as the
// others where eyes look, and the first bounce of a uniform sky, off surfaces that reflect half of it. So the
// meshes stay as they are when colours are edited. The same few shadow rays serve all points (instant
// radiosity; Keller 1997), so that neighbours which see the same have no difference.

// SentLight is irradiance over pi, or the same relative to that of an open point under the same sky.
struct SentLight {
  float lamps = 0.0f;    // directly and by the first bounce
  float bounced = 0.0f;  // of a uniform sky
};

template <>
inline constexpr bool kPlainBytes<SentLight> = true;

class SurfaceLight {
 public:
  // All arguments but `lights` must outlive this. Lamps that are shaded per pixel, because they have shadow
  // cubes, send only what they bounce.
  SurfaceLight(const Scene& scene, const GroupGeometry& geometry, const RayScene& rays,
               const SurfaceColors& colors, std::span<const PlannedLight> lights,
               const Importance& importance, const ShadowProbe& probe);

  SentLight at(std::span<const SampleOrigin> origins, const glm::vec3& normal) const;
  // Return the light of a uniform sky, relative to that of an open point, and of all lamps, as eyes see them
  // on average.
  float meanSky() const { return mean_sky_; }
  float meanLamps() const { return mean_lamps_; }

 private:
  struct Bouncer {  // a point that eyes see, as a small disc that reflects
    glm::vec3 position, normal;
    float area = 0.0f;   // m^2
    float sky = 0.0f;    // what it reflects of a uniform sky, relative to an open white surface
    float lamps = 0.0f;  // and of the lamps
  };
  SentLight bouncedAt(const SampleOrigin& origin, const glm::vec3& normal) const;
  // Adds what each lamp sends, at unit strength.
  void addLamps(std::span<const SampleOrigin> origins, const glm::vec3& normal, std::span<float> sums) const;

  const RayScene& rays_;
  std::vector<float> strengths_, at_vertices_;  // of each lamp, and of those that are not shaded per pixel
  Emitters emitters_;
  std::vector<Bouncer> bouncers_;
  float mean_sky_ = 0.0f, mean_lamps_ = 0.0f;
};

inline constexpr std::size_t kPointsPerRange = 64;  // probed points in one range of work

// Remembers what a group's points were found to be hidden from, and what light surfaces send them, over all
// rounds of refinement. Triangles change between rounds, but surfaces stay in place, so that most points are
// known already.
class ProbedPoints {
 public:
  // The probe outlives this.
  explicit ProbedPoints(const ShadowProbe& probe) : probe_(&probe) {}

  const ShadowProbe& shadowProbe() const { return *probe_; }

  // Returns the number of a point. New points must be probed before they are asked about.
  std::uint32_t numberOf(const glm::vec3& position, const glm::vec3& normal, SampleKind kind,
                         std::span<const SampleOrigin> origins);
  // Traces rays from all new points through the group before any split, whose key this is. Returns false when
  // stopped.
  bool probe(const Key& scene_key, const RayScene& rays, const SurfaceLight& light,
             const BakeContext& context);

  std::span<const std::uint16_t> masksAt(std::uint32_t point) const {
    return std::span(masks_).subspan(point * probe_->packets(), probe_->packets());
  }
  const SentLight& lightAt(std::uint32_t point) const { return light_[point]; }
  bool seen(std::uint32_t point) const { return seen_[point] != 0; }
  std::uint64_t raysTraced() const { return traced_; }
  std::uint64_t raysKept() const { return kept_; }

 private:
  struct Point {
    glm::vec3 normal{0.0f};
    SampleKind kind = SampleKind::Diffuse;
    std::vector<SampleOrigin> origins;
  };

  const ShadowProbe* probe_;
  std::unordered_map<VertexKey, std::uint32_t, VertexKeyHash> known_;
  std::vector<Point> missing_;        // those that follow the ones in seen_
  std::vector<std::uint16_t> masks_;  // ShadowProbe::packets() for each point
  std::vector<SentLight> light_;
  std::vector<std::uint8_t> seen_;  // 1 if the point can be seen at all
  std::uint64_t traced_ = 0, kept_ = 0;
};

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

// Returns a number for each vertex of a group; vertices at exactly the same position have the same one.
std::vector<std::uint32_t> placesIn(const GroupGeometry& geometry);

// Returns the same for an edge between two places or vertices from either end.
inline std::uint64_t pairOf(std::uint32_t a, std::uint32_t b) {
  const auto [low, high] = std::minmax(a, b);
  return std::uint64_t{low} << 32 | high;
}

// Finds where another surface cuts an edge of a face. Such a face is lit on one side of the cut and dark on
// the other. No vertex may mix both, and none should lie in the cut: each side gets a vertex of its own, a
// little before it.

// A vertex lies before a surface that cuts its face by this share of the extent, which is a few steps of the
// lattice of positions.
inline constexpr float kBeforeCut = 1.0f / 32768.0f;

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

class GroupRefiner {
 public:
  // Few rays say where something may be wrong. Their noise is as large as small errors are: the triangles
  // that it makes look worst are split and those that it makes look right stay, so that in the end the figure
  // is under the bound and the error is not. Many rays therefore probe again before anything is split. Glossy
  // surfaces are not probed again: their pictures gain nothing from it, and their probes cost most.
  // The scene and the probes outlive this. The geometry is that before any split: rays are traced against it
  // in all rounds. Glossy surfaces are refined `with_glossy` alone.
  GroupRefiner(const RefineScene& from, const GroupGeometry& geometry, const ShadowProbe& few,
               const ShadowProbe& many, bool with_glossy)
      : from_(from), geometry_(geometry), few_(few), many_(many), with_glossy_(with_glossy) {}
  GroupRefiner(const GroupRefiner&) = delete;
  GroupRefiner& operator=(const GroupRefiner&) = delete;

  // Comes before all else. Errors: no memory for the hierarchy, images that cannot be decoded.
  Result<void> prepare(const RigidGroup& group);

  // Measures the relative error of every triangle that eyes see, by many rays where it could matter for
  // `bound`. Errors: no memory for the hierarchy. False when stopped.
  Result<bool> measure(const GroupGeometry& geometry, double bound, const BakeContext& context);

  // Returns the RMS of what interpolation gets wrong at a point, relative to the light that arrives there, in
  // all but the worst 5 % of the regions that eyes see.
  double relativeError() const;
  std::uint64_t raysTraced() const { return few_.raysTraced() + many_.raysTraced(); }
  std::uint64_t raysKept() const { return few_.raysKept() + many_.raysKept(); }

  // Fills flat faces that are beyond the bound as they were measured (flat_faces.hpp).
  void fillFaces(const RigidGroup& group, const GroupGeometry& geometry, double bound,
                 const CopiesOfMeshes& copies, std::size_t room,
                 std::vector<std::vector<bundle::MeshData>>& meshes) const;

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
  struct SeenPlace {  // a point of the group before any split that an eye sees
    FacePoint point;
    std::uint32_t ray = 0, region = 0;
    float share = 0.0f;
  };
  struct Inner {  // a point inside a triangle
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

  const RefineScene& from_;
  const GroupGeometry geometry_;  // this and what follows are of the group before any split
  std::vector<PlannedLight> lights_;
  std::optional<RayScene> rays_;
  Importance importance_;
  std::optional<SurfaceColors> colors_;
  std::optional<SurfaceLight> light_;
  std::vector<SeenPlace> seen_;
  Key key_;
  ProbedPoints few_, many_;
  bool with_glossy_;
  std::unordered_map<VertexKey, float, VertexKeyHash> seen_at_;  // of the points of all rounds
  bool chosen_ = false;       // triangles were marked, so that few rays are no longer right on average
  std::vector<Inner> inner_;  // by triangle, and then by region
  std::vector<Part> parts_;   // in the same order
};

}  // namespace lambent::baker
