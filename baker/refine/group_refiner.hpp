// Follows one rigid group through all rounds of refinement: it finds what is hidden from the group's vertices
// and from points inside its triangles, how wrong interpolation over triangles is, and which edges are to be
// split.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/jobs/bake_context.hpp"
#include "baker/refine/marked_edges.hpp"
#include "baker/refine/probed_points.hpp"
#include "baker/refine/shadow_probe.hpp"
#include "baker/refine/wedges.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// Few rays tell where something may be wrong. Their noise is as large as small errors are: the triangles that
// it makes look worst are split and those that it makes look right stay, so that in the end the figure is
// under the bound and the error is not. Many rays therefore look again before anything is split. Glossy
// surfaces are not looked at again: their pictures gain nothing from it, and their probes cost most.
struct RefineProbes {
  const ShadowProbe &few, &many;
};

class GroupRefiner {
 public:
  // The probes outlive this. Glossy surfaces are looked at `with_glossy` alone. With `for_wedges` it also
  // keeps what addLacks() needs: 300 bytes per triangle, and as much per probe while measuring.
  GroupRefiner(const RefineProbes& probes, bool with_glossy, bool for_wedges)
      : few_(probes.few), many_(probes.many), with_glossy_(with_glossy), for_wedges_(for_wedges) {}

  // alpha_maps outlive this. The geometry is that before any split: rays are traced against it in all rounds.
  void prepare(const GroupGeometry& geometry, const Scene& scene, const AlphaMaps& alpha_maps);

  // Measures the area times the square of the relative error of every triangle, by many rays where it could
  // matter for `bound`. Errors: no memory for the hierarchy. False when stopped.
  Result<bool> measure(const GroupGeometry& geometry, double bound, const BakeContext& context);

  bool measured() const { return !measured_.empty(); }
  // Returns the RMS over all that can be seen of what interpolation gets wrong at a point, relative to the
  // direct light that arrives there: an eye in a dark room sees errors that are small beside open light.
  double relativeError() const;
  std::uint64_t raysTraced() const { return few_.raysTraced() + many_.raysTraced(); }
  std::uint64_t raysKept() const { return few_.raysKept() + many_.raysKept(); }

  // Marks edges of the worst triangles, until the remaining error is within the bound or `room` new vertices
  // are spent. Returns how many edges were marked. Errors: no memory for the hierarchy.
  Result<std::size_t> markWorst(std::size_t group, const GroupGeometry& geometry, double bound,
                                std::size_t& room, MarkedEdges& edges);

  // Marks edges that another surface cuts between an end in the dark and one in the light, as far as `room`
  // goes, whatever errors were measured: the inner points of such faces may all lie inside that surface.
  // Returns how many edges were marked, or nothing when stopped. Errors: no memory for the hierarchy.
  Result<std::optional<std::size_t>> markLeaks(std::size_t group, const GroupGeometry& geometry,
                                               std::size_t& room, MarkedEdges& edges,
                                               const BakeContext& context);

  // Appends what interpolation lacked inside the triangles of `draw` when last measured: values of some low
  // bands, and areas, per triangle.
  void addLacks(const DrawGeometry& draw, FaceLacks& lacks) const;
  static constexpr std::size_t kLackValues = 36;

 private:
  struct Inner {  // a point inside a triangle
    std::uint32_t triangle = 0, point = 0;
    glm::vec3 weights{0.0f}, normal{0.0f};  // of the corners; the shading normal
  };
  // Rays say this of a triangle; all is times its area.
  struct Measured {
    double square_error = 0.0;  // without bias from noise, so it may be below 0
    double with_noise = 0.0;    // the square that all rays together show, which noise makes larger
    double seen = 0.0;          // the part of the area that can be seen
  };

  // Returns the triangles that are looked at: those whose vertices pictures show, which they do not where
  // there are texels, and whose splits would show.
  std::vector<std::uint32_t> triangles(const GroupGeometry& geometry) const;
  // Fills in measured_ of the triangles listed.
  Result<bool> measureBy(ProbedPoints& points, const GroupGeometry& geometry, const SampleSet& samples,
                         std::span<const std::uint32_t> triangles, const BakeContext& context);
  // Returns the triangles that have nearly all of a square error, whatever noise hides, but for those that
  // few rays are sure of; in ascending order.
  std::vector<std::uint32_t> trianglesThatMatter(double square_error) const;
  double squareError() const;
  double seenArea() const;
  struct Edge {
    std::uint32_t a, b, triangle;
  };
  // Returns for each edge the share of the way from a to b at which it is split because another surface cuts
  // it, or 0, also if the way is longer than `longest`. Errors: no memory for the hierarchy.
  Result<std::vector<float>> cutsOf(const GroupGeometry& geometry, std::span<const Edge> list, float longest);
  void keepLacks(const GroupGeometry& geometry, std::span<const Inner> inner,
                 std::span<const std::uint8_t> seen, std::span<const float> lacks);

  ProbedPoints few_, many_;
  bool with_glossy_, for_wedges_;
  std::optional<ProbedScene> scene_;
  std::vector<glm::vec3> scene_normals_;  // of the scene's triangles, which are never split
  float diagonal_ = 0.0f;
  bool chosen_ = false;             // triangles were marked, so that few rays are no longer right on average
  std::vector<Measured> measured_;  // of each triangle
  std::vector<double> triangle_area_;
  std::vector<float> triangle_lack_;
};

}  // namespace lambent::baker
