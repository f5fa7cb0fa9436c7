// Refinement where shadows change: splits edges of meshes until interpolation over triangles carries what is
// hidden from their points within a bound (Krivanek and others 2004 refine by transfer, too). The error is
// probed inside triangles by rays; where it is too large, the worst triangles are split, round after round.
// Faces that see nothing change are left as they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "baker/cache/cache.hpp"
#include "baker/import/scene.hpp"
#include "baker/jobs/progress.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "baker/transport/alpha_map.hpp"

namespace lambent::baker {

struct RefineOptions {
  float bound = 0.01f;     // on the error of each group: relative RMS over its surface, against open light
  std::size_t rays = 512;  // per probe, over the sphere
  int rounds = 12;         // at most
  // The scene never gets more vertices than so many times as it had and so many more, nor more than so many
  // in all.
  double most_growth = 1.5;
  std::size_t most_added = 20'000;
  std::size_t most_vertices = std::size_t{1} << 31;
  // Wedges that may be added to the vertices of glossy surfaces, by vertices after all splits (fans.hpp).
  double most_wedges = 0.0;
};

struct RefineReport {
  std::size_t vertices_before = 0, vertices_after = 0;
  std::size_t fans = 0;  // values beyond one for each position and normal
  // Of the group that was worst, before fans: what interpolation over the triangles got wrong.
  double error_before = 0.0, error_after = 0.0;
  std::uint64_t rays = 0;       // traced
  std::uint64_t rays_kept = 0;  // that what was found in the cache stands for
};

// meshes[mesh][primitive], changed in place; the same primitives as the scene's. Draws of one mesh share its
// splits. cache: may be null; keeps the outcome, and what was probed in each group. Errors: no memory for the
// hierarchy, "stopped". Deterministic for any number of threads.
Result<RefineReport> refineMeshes(const Scene& scene, const std::vector<RigidGroup>& groups,
                                  const std::vector<std::shared_ptr<const AlphaMap>>& alpha_maps,
                                  bool with_glossy, const RefineOptions& options,
                                  std::vector<std::vector<bundle::MeshData>>& meshes, Progress& progress,
                                  const std::stop_token& stop, Cache* cache = nullptr);

}  // namespace lambent::baker
