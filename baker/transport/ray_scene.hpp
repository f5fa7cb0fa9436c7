// The room baker/transport owns a group's geometry, samples, ray directions and surface colours, and this
// file owns visibility inside the group, by Embree. A group's geometry and the scene's materials come in;
// masks of blocked rays and first hits go out. Solid surfaces and single-sided back faces block rays, except
// flipped faces (group_geometry.hpp); alphaMode MASK blocks where its alpha says so, and alphaMode BLEND and
// panes (KHR_materials_transmission) block nothing: panesOn() finds the latter (panes.hpp). All rays of one
// sample are traced in packets of sixteen sorted directions, which was measured to be 1.2 to 2.8 times as
// fast as single rays or one direction over many samples. Calls are safe from any thread; only build() can
// fail.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>

#include "baker/transport/direction_table.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/ray_packets.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

// RayHit is the first hit of a table's ray: a front, or either side of a double-sided surface.
struct RayHit {
  std::uint32_t ray = 0;       // index in the table
  std::uint32_t triangle = 0;  // into GroupGeometry::triangles; of the back draw if the ray hit the back
  float u = 0.0f, v = 0.0f;    // barycentric weights of corners 1 and 2
  float distance = 0.0f;
  glm::vec3 passed{1.0f};  // what panes on the way pass of the light (panes.hpp)
};

// A RaySegment is the stretch between two points.
struct RaySegment {
  glm::vec3 origin, direction;  // the direction is unit
  float length;                 // the far end is exclusive
};

// FirstHit is the first hit of a ray that belongs to no table.
struct FirstHit {
  static constexpr std::uint32_t kNothing = 0xffffffffu;
  std::uint32_t triangle = kNothing;  // as in RayHit
  float u = 0.0f, v = 0.0f;
  float distance = std::numeric_limits<float>::infinity();
  bool back = false;  // the back of a single-sided surface, which blocks and sends no light

  bool any() const { return triangle != kNothing; }
};

// A PaneHit is where a ray passes a face of a pane.
struct PaneHit {
  std::uint32_t ray = 0;       // index in the list of rays
  std::uint32_t triangle = 0;  // as in RayHit
  float u = 0.0f, v = 0.0f, distance = 0.0f;
  bool entering = false;  // met from its front
  bool back = false;      // the back of a single-sided surface, which sends no light
};

// The shares of an origin's rays whose first hit is the back of a single-sided surface (`back`), or that or
// nearer than the origin's reach (`near`).
struct MetShares {
  float back = 0.0f, near = 0.0f;
};

// Sets bit k of masks[p] where ray 16 p + k lies below the horizons of all origins, as RayScene::trace() does
// where nothing is in the way.
void blockBelowHorizons(const SampleRays& rays, std::span<std::uint16_t> masks);

class RayScene {
 public:
  // `alpha_maps` as loadAlphaMaps gives them. Errors: Embree cannot be set up or runs out of memory.
  static Result<RayScene> build(const GroupGeometry& geometry, const Scene& scene, AlphaMaps alpha_maps);
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

  // Bit k of masks[p] is set where ray 16 p + k is blocked. Rays are dealt out over the origins by their
  // weights; below the horizons of all of them they are blocked untraced, or mirrored. Returns how many rays
  // were traced.
  std::uint32_t trace(const SampleRays& rays, std::span<std::uint16_t> masks) const;

  // Does what trace() does, and appends the hits of blocked rays to `hits`, in the order of the rays. Backs
  // of single-sided surfaces block and are not listed. `mostly_blocked` is a hint about which way is faster,
  // and must be the same if the same result is wanted.
  std::uint32_t traceHits(const SampleRays& rays, bool mostly_blocked, std::span<std::uint16_t> masks,
                          std::vector<RayHit>& hits) const;

  // Sets blocked[i] to 1 if something lies between the ends of segment i, else to 0.
  void occluded(std::span<const RaySegment> segments, std::span<std::uint8_t> blocked) const;

  // Finds what each ray hits first on its stretch. This is fastest if sixteen neighbours of the list have
  // similar directions.
  void firstHits(std::span<const RaySegment> rays, std::span<FirstHit> hits) const;

  // Returns whether panes weaken any ray.
  bool hasPanes() const;
  // Finds the panes that each ray passes on its stretch, ray by ray, the nearest first.
  void panesOn(std::span<const RaySegment> rays, std::vector<PaneHit>& hits) const;

  // Fills in what the rays of each origin hit. Returns the share of all rays that hit anything.
  float meet(const SampleRays& rays, std::span<MetShares> shares) const;

 private:
  struct State;
  explicit RayScene(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lambent::baker
