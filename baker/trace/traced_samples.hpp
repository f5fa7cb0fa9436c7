// Holds a rigid group as rays see it: its geometry and samples, the ray hierarchy, the colours of its
// surfaces and the lights that belong to it. All of it is borrowed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>

#include "baker/importance/importance.hpp"
#include "baker/trace/hits.hpp"
#include "baker/trace/mirror_paths.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/panes.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

// Everything that a TracedScene refers to must outlive the bake.
struct TracedScene {
  const Scene& scene;
  const GroupGeometry& geometry;
  const SampleSet& samples;
  const RayScene& rays;
  const SurfaceColors& colors;
  std::span<const PlannedLight> lights;
  const MirrorPaths* mirrors = nullptr;  // null if no surface is glossy or layered
  // False if no part of the group hides light from another (effect_plan.hpp): samples see all that is
  // above the horizons of their faces.
  bool shadows = true;
  const SampleImportance* importance = nullptr;  // of the samples; null: all count alike

  // Returns whether pictures show anything of a triangle, or of light that it sends.
  bool matters(std::uint32_t triangle) const {
    const glm::uvec3 corners = geometry.triangles[triangle];
    const auto corner = [&](int c) { return importance->matters(samples.vertex_sample[corners[c]]); };
    return !importance || corner(0) || corner(1) || corner(2);
  }

  TracedScene withSamples(const SampleSet& others) const {
    return {scene, geometry, others, rays, colors, lights, mirrors, shadows, nullptr};
  }
};

// Finds what a sample sees: where its rays start, what they hit, and whether it lies inside something.
// Everything that traces from samples uses it, one object per thread and range of samples.

// How many rays a sample has: the usual number, twice as many where much is in the way, or few where it does
// not matter to pictures.
enum class RayCount : std::uint8_t { Usual, Twice, Few };
inline constexpr std::size_t kRayCounts = 3;
std::size_t raysOf(RayCount count, std::size_t usual);

// Both lists have one entry per sample.
struct SampleVisibilities {
  std::vector<std::uint8_t> valid;  // 0: the sample lies inside something, and is filled from its neighbours
  std::vector<RayCount> ray_counts;
};

class SampleVisibility {
 public:
  // Everything must outlive it. No rays are traced where the scene has no shadows.
  SampleVisibility(const TracedScene& scene, const InsideTestTables& glances)
      : scene_(scene), inside_test_(glances) {}

  // Moves to sample `s`: finds its frame, the origins that lie outside, and how many rays to trace.
  void stand(std::size_t s);
  // Traces the table's rays, and records what they hit if `wants_hits`. Returns how many were traced, which
  // is none if the sample has no face.
  std::uint32_t look(const DirectionTable& table, bool wants_hits,
                     BelowHorizon below = BelowHorizon::Blocked);

  // False if the sample lies inside or under something, or has no face.
  bool valid() const { return seen_.valid; }
  RayCount rayCount() const { return ray_count_; }
  const glm::dmat3& frame() const { return frame_; }  // group_from_local
  std::span<const SampleOrigin> origins() const { return seen_.origins; }
  // Bit k of blocked()[p] is set if ray 16 p + k is blocked.
  std::span<const std::uint16_t> blocked() const { return blocked_; }
  // Includes the faces of panes.
  std::span<const RayHit> hits() const { return hits_; }
  // Lists the open rays that pass panes.
  std::span<const DimmedRay> dimmed() const { return dimmed_; }

  // Appends the hits to `out`, with what panes before them pass in place of colours (paintHits).
  void keepHits(std::vector<GatherHit>& out) const;

 private:
  const TracedScene scene_;
  const InsideTestTables& inside_test_;
  glm::dmat3 frame_{1.0};
  SeenOrigins seen_;
  RayCount ray_count_ = RayCount::Usual;
  std::vector<std::uint16_t> blocked_;
  std::vector<RayHit> hits_;
  std::vector<DimmedRay> dimmed_;
};

// Looks up what the surfaces at hits reflect, and removes hits on surfaces that reflect nothing. Then follows
// rays from mirrors, where the scene has any; `first` is the first sample of the hits.
void paintHits(const TracedScene& scene, std::size_t first, const RayDirection& direction, RangeHits& hits);

}  // namespace lambent::baker
