// Fits direct light at the vertices so that interpolation over faces shows it best: it traces rays from
// inside the faces over which light changes, and fits the vertices to what they see by least squares
// (trace/vertex_fit.hpp). Bounces gather from the fitted values, and fit what they bring in the same way.
#pragma once

#include <cstdint>
#include <optional>

#include "baker/effects/diffuse/direct.hpp"
#include "baker/effects/glossy/glossy_direct.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

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

}  // namespace lambent::baker
