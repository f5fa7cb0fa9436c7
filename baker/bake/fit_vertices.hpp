// Direct light at the vertices as interpolation over faces shows it best: rays from inside the faces over
// which it changes, and a least-squares fit to what they see (trace/vertex_fit.hpp). Bounces gather
// from the fitted values; what they bring to diffuse samples is added at the vertices.
#pragma once

#include <cstdint>
#include <optional>

#include "baker/effects/diffuse/direct.hpp"
#include "baker/effects/glossy/glossy_direct.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

struct FitFigures {
  std::size_t points = 0;  // inside faces
  std::uint64_t rays = 0, rays_kept = 0;
  double ray_seconds = 0.0;
};

// Fits plain and normal-mapped samples. The key of the context is that of the rays of the vertices. Returns
// nothing if stopped. The result does not depend on the number of threads.
std::optional<FitFigures> fitDiffuse(const DirectPass& pass, const TracedScene& scene, DirectResult& direct,
                                     const BakeContext& context);
// Fits glossy samples. Where hits are kept for bounces, those of the points are, too, in what is left of the
// memory for hits, and glossy.inside has them.
std::optional<FitFigures> fitGlossy(const GlossyPass& pass, GlossyDirect& glossy, const BakeContext& context);

}  // namespace lambent::baker
