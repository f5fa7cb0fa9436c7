// Computes the light of a group's surfaces, diffuse and glossy together: direct light of both, its fit to the
// faces, and the bounces between them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "baker/bake/group_scene.hpp"
#include "baker/bake/picture_error.hpp"
#include "baker/effects/diffuse/bounces.hpp"
#include "baker/effects/diffuse/direct.hpp"
#include "baker/effects/glossy/glossy_direct.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// Fits direct light at the vertices so that interpolation over faces shows it best: it traces rays from
// inside the faces over which light changes, and fits the vertices to what they see by least squares
// (trace/vertex_fit.hpp). Bounces gather from the fitted values, and fit what they bring in the same way.

struct FitFigures {
  std::size_t points = 0;  // points inside faces
  std::uint64_t rays = 0, rays_kept = 0;
  double ray_seconds = 0.0;
};

// Fits diffuse samples, with and without normal maps. If hits are kept for bounces, the points inside faces
// are kept in direct.inside. The key of the context is that of the rays of the vertices. Returns nothing if
// stopped. The result does not depend on the number of threads.
std::optional<FitFigures> fitDiffuse(const DirectPass& pass, const TracedScene& scene, DirectResult& direct,
                                     const BakeContext& context);
// Fits glossy samples. If hits are kept for bounces, the hits of the points inside faces are kept too, as far
// as the memory for hits allows, in glossy.inside.
std::optional<FitFigures> fitGlossy(const GlossyPass& pass, GlossyDirect& glossy, const BakeContext& context);

// SurfaceFigures measure the bake of one group's surfaces, whether it was done now or found in the cache.
struct SurfaceFigures {
  std::uint64_t filled_samples = 0, glossy_samples = 0;
  std::uint64_t hit_bytes = 0;  // memory of the hits kept for the bounces
  double worst_error = 0.0, worst_glossy_error = 0.0, left_out = 0.0;
  std::vector<double> pass_energy;
  struct Rays {
    std::uint64_t traced = 0, kept = 0;  // in this run; saved by results of earlier runs
  };
  Rays diffuse, glossy;
  double ray_seconds = 0.0;  // of this run
  std::optional<bundle::PictureError> picture_error;
  float codes_bound = 0.0f, glossy_codes_bound = 0.0f;
};

struct SurfaceTransport {
  DirectResult direct;
  std::optional<GlossyDirect> glossy;  // set if there are glossy samples
  std::optional<BounceResult> bounced;
  // Samples inside faces that gathered bounces too.
  std::size_t inside_diffuse = 0, inside_glossy = 0;
  TracedView view;
  SurfaceFigures figures;  // without the errors of coding
};

// The group must be prepared for rays. Returns nothing if stopped. Checkpoints of the bounces stay until
// dropTransport().
std::optional<SurfaceTransport> transportLight(const GroupScene& group, const BakeContext& context);
// Measures how wrong pictures of the surfaces are, as codes show them; without codes, if they are null.
std::optional<bundle::PictureError> shownBy(const GroupScene& group, const SurfaceTransport& light,
                                            const std::vector<std::vector<CodedTransfer>>* cells);
void dropTransport(const GroupScene& group, const SurfaceTransport& light, const BakeContext& context);

}  // namespace lambent::baker
