// One rigid group through all rounds of refinement: what is hidden from its vertices and from points inside
// its triangles, what interpolation over triangles gets wrong of it, and which edges are to be split.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <unordered_map>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/cache/cached_ranges.hpp"
#include "baker/jobs/progress.hpp"
#include "baker/refine/marked_edges.hpp"
#include "baker/refine/shadow_probe.hpp"
#include "baker/refine/wedges.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/vertex_key.hpp"

namespace lambent::baker {

class GroupRefiner {
 public:
  // for_wedges: also keeps what addLacks() gives, 300 bytes a triangle and as much for each probe while
  // measuring.
  GroupRefiner(const ShadowProbe& probe, bool for_wedges) : probe_(probe), for_wedges_(for_wedges) {}

  // alpha_maps outlive this. The geometry is that before any split: rays are traced against it in all rounds.
  void prepare(const GroupGeometry& geometry, const Scene& scene,
               const std::vector<std::shared_ptr<const AlphaMap>>& alpha_maps, Cache* cache);

  // Area times square error of every triangle. Errors: no memory for the hierarchy. False when stopped.
  Result<bool> measure(const GroupGeometry& geometry, Progress& progress, const std::stop_token& stop);

  double relativeError() const { return area_ > 0.0 ? std::sqrt(std::max(0.0, square_error_) / area_) : 0.0; }
  std::uint64_t raysTraced() const { return traced_; }
  std::uint64_t raysKept() const { return rays_kept_; }

  // Marks edges of the worst triangles, until the rest is within the bound or `room` new vertices are spent.
  // Returns how many edges were marked.
  std::size_t markWorst(std::size_t group, const GroupGeometry& geometry, double bound, std::size_t& room,
                        MarkedEdges& edges) const;

  // What interpolation lacked inside the triangles when last measured: values of some low bands and areas,
  // per triangle of the geometry; of triangles of `draw`.
  void addLacks(const DrawGeometry& draw, FaceLacks& lacks) const;
  static constexpr std::size_t kLackValues = 36;

 private:
  struct Point {
    glm::vec3 normal{0.0f};
    SampleKind kind = SampleKind::Diffuse;
    std::vector<SampleOrigin> origins;
    std::uint32_t shadow = 0;  // place in masks_
  };
  struct Inner {  // a point inside a triangle
    std::uint32_t triangle = 0, shadow = 0;
    glm::vec3 weights{0.0f}, normal{0.0f};  // of the corners; of shading
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
  Result<bool> probe(const std::vector<Point>& missing, Progress& progress, const std::stop_token& stop);

  const ShadowProbe& probe_;
  bool for_wedges_;
  Keep keep_;  // of the geometry that rays are traced against
  std::function<Result<RayScene>()> build_rays_;
  std::optional<RayScene> rays_;  // once something was not found
  float diagonal_ = 0.0f;
  // Where shadows were probed: triangles come and go, surfaces stay where they are.
  std::unordered_map<VertexKey, std::uint32_t, VertexKeyHash> known_;
  std::vector<std::uint16_t> masks_;  // ShadowProbe::packets() each
  std::vector<std::uint8_t> seen_;    // by anybody
  std::vector<double> triangle_error_, triangle_area_;
  std::vector<float> triangle_lack_;
  double square_error_ = 0.0, area_ = 0.0;
  std::uint64_t traced_ = 0, rays_kept_ = 0;
};

}  // namespace lambent::baker
