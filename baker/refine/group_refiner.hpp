// Follows one rigid group through all rounds of refinement: it finds what is hidden from the group's vertices
// and from points inside its triangles, how wrong interpolation over triangles is, and which edges are to be
// split.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/jobs/bake_context.hpp"
#include "baker/refine/marked_edges.hpp"
#include "baker/refine/shadow_probe.hpp"
#include "baker/refine/wedges.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/vertex_key.hpp"

namespace lambent::baker {

class GroupRefiner {
 public:
  // With `for_wedges` it also keeps what addLacks() needs: 300 bytes per triangle, and as much per probe
  // while measuring.
  GroupRefiner(const ShadowProbe& probe, bool for_wedges) : probe_(probe), for_wedges_(for_wedges) {}

  // alpha_maps outlive this. The geometry is that before any split: rays are traced against it in all rounds.
  void prepare(const GroupGeometry& geometry, const Scene& scene, const AlphaMaps& alpha_maps);

  // Measures the area times the square of the relative error of every triangle. Errors: no memory for the
  // hierarchy. False when stopped.
  Result<bool> measure(const GroupGeometry& geometry, const BakeContext& context);

  // Returns the RMS over all that can be seen of what interpolation gets wrong at a point, relative to the
  // direct light that arrives there: an eye in a dark room sees errors that are small beside open light.
  double relativeError() const { return area_ > 0.0 ? std::sqrt(std::max(0.0, square_error_) / area_) : 0.0; }
  std::uint64_t raysTraced() const { return traced_; }
  std::uint64_t raysKept() const { return rays_kept_; }

  // Marks edges of the worst triangles, until the remaining error is within the bound or `room` new vertices
  // are spent. Returns how many edges were marked.
  std::size_t markWorst(std::size_t group, const GroupGeometry& geometry, double bound, std::size_t& room,
                        MarkedEdges& edges) const;

  // Appends what interpolation lacked inside the triangles of `draw` when last measured: values of some low
  // bands, and areas, per triangle.
  void addLacks(const DrawGeometry& draw, FaceLacks& lacks) const;
  static constexpr std::size_t kLackValues = 36;

 private:
  struct Point {
    glm::vec3 normal{0.0f};
    SampleKind kind = SampleKind::Diffuse;
    std::vector<SampleOrigin> origins;
    std::uint32_t shadow = 0;  // index into masks_
  };
  struct Inner {  // a point inside a triangle
    std::uint32_t triangle = 0, shadow = 0;
    glm::vec3 weights{0.0f}, normal{0.0f};  // of the corners; the shading normal
    SampleKind kind = SampleKind::Diffuse;
  };
  void keepLacks(const GroupGeometry& geometry, std::span<const Inner> inner,
                 std::span<const std::uint8_t> seen, std::span<const float> lacks);
  std::uint32_t shadowAt(const glm::vec3& position, const glm::vec3& normal, SampleKind kind,
                         std::span<const SampleOrigin> origins, std::vector<Point>& missing);
  std::span<const std::uint16_t> masksAt(std::uint32_t shadow) const {
    return std::span(masks_).subspan(shadow * probe_.packets(), probe_.packets());
  }
  // Fills in masks_ at the missing points.
  Result<bool> probe(const std::vector<Point>& missing, const BakeContext& context);

  const ShadowProbe& probe_;
  bool for_wedges_;
  Key key_;  // of the geometry that rays are traced against
  std::function<Result<RayScene>()> build_rays_;
  std::optional<RayScene> rays_;  // built once something is not in the cache
  float diagonal_ = 0.0f;
  // This says where shadows were probed. Triangles change between rounds, but surfaces stay in place.
  std::unordered_map<VertexKey, std::uint32_t, VertexKeyHash> known_;
  std::vector<std::uint16_t> masks_;  // ShadowProbe::packets() for each point
  std::vector<std::uint8_t> seen_;    // 1 if the point can be seen at all
  std::vector<double> triangle_error_, triangle_area_;
  std::vector<float> triangle_lack_;
  double square_error_ = 0.0;
  double area_ = 0.0;  // of what can be seen
  std::uint64_t traced_ = 0, rays_kept_ = 0;
};

}  // namespace lambent::baker
