// Computes how much of the sky a rough mirror sees, from the first bands t_k = (1/pi) ∫ V max(n·s, 0) y_k ds
// of transfer without bounces. For a mirrored direction r at an angle to the normal, weights b make
//   Σ_k b_k t_k = ∫ V(s) K(s) ds,   K(s) = Σ_k b_k y_k(s) max(n·s, 0)/pi,
// with K as near to the lobe about r as it gets (least squares over the hemisphere), and 1 where all is open.
// Bands of V alone would be better, but bundles do not have them; reading them off at r would mix in what
// stands higher, which the cosine favours. K is symmetric about the plane of the normal and r, so it is
// stored by weights of zonal functions (sh/zonal_factors.hpp) over cosine and roughness. No GL.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec4.hpp>

#include "runtime/transfer/seen_sky_shared.h"

namespace lambent::lighting {

inline constexpr std::uint32_t kSeenCosines = 24, kSeenRoughnesses = 9;
inline constexpr std::uint32_t kSeenLayers = (transfer::kSeenWeights + 3) / 4;

struct SeenKernel {
  // Four weights to a vec4: [layer][roughness][cosine], with roughness 0..1 and bundle::angleAxis(cosine) in
  // even steps. The last of sixteen is unused.
  std::vector<glm::vec4> texels;
};

SeenKernel makeSeenKernel();

}  // namespace lambent::lighting
