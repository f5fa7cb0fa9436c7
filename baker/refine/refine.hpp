// The room baker/refine splits edges where light changes, until interpolation over triangles shows light
// within a bound in nearly all regions that eyes see (baker/importance; Krivanek and others 2004 refine by
// transfer, too). Light is that of the sky, of lamps, and what bounces once. The error is probed inside
// triangles by rays; where it is too large, the worst triangles are split, round after round. Faces across
// which nothing changes, or that nobody sees, are left alone. The scene, its groups and decoded meshes come
// in; the meshes with more vertices, and a report, go out. It works on several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "baker/import/image.hpp"
#include "baker/import/scene.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/plan/effect_plan.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "baker/transport/surface_colors.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

struct RefineOptions {
  float bound = 0.01f;  // on each group's error, see GroupRefiner::relativeError()
  // Rays of a probe over the sphere: few tell where much is wrong, many where little is.
  std::size_t rays = 512, many_rays = 2048;
  int rounds = 48;     // at most this many
  bool glossy = true;  // false: surfaces with glossy samples are left as they are
  // What is drawn gets at most most_growth times as many vertices as it had and most_added more, and never
  // more than most_vertices in all. A mesh that is drawn several times counts as often, as its samples do.
  double most_growth = 1.5;
  std::size_t most_added = 20'000;
  std::size_t most_vertices = std::size_t{1} << 31;
};

struct RefineReport {
  std::size_t vertices_before = 0, vertices_after = 0;
  // These are interpolation errors of the worst group.
  double error_before = 0.0, error_after = 0.0;
  bool at_limit = false;        // of vertices or rounds, before the bound was reached
  std::uint64_t rays = 0;       // traced
  std::uint64_t rays_kept = 0;  // rays that results in the cache saved
};

// A RefineScene is everything that refinement reads beside the meshes.
struct RefineScene {
  const Scene& scene;
  const std::vector<RigidGroup>& groups;
  const std::vector<PlannedTransport>& transport;  // groups without shadows are left as they are
  bool with_glossy;                                // materials that are not diffuse have glossy samples
  DecodedImages& images;
};

// Changes meshes[mesh][primitive] in place; they must be the same primitives as the scene's. Draws of one
// mesh share its splits. The outcome, and the rays probed in each group, are kept in the cache. Errors: no
// memory for the ray hierarchy, "stopped". The result does not depend on the number of threads.
Result<RefineReport> refineMeshes(const RefineScene& from, const RefineOptions& options,
                                  std::vector<std::vector<bundle::MeshData>>& meshes,
                                  const BakeContext& context);

}  // namespace lambent::baker
