// Looks at a rigid group with a few thousand rays, to tell what its light is like before anything is baked:
// how much of the sky its surfaces hide from each other, how much light each bounce brings, and how much of
// it few bands carry. Paths start from points on all draws, and surfaces reflect alike in all directions. The
// scene and its plan come in, figures go out. The same scene gives the same figures.
#pragma once

#include <cstdint>
#include <vector>

#include "baker/import/image.hpp"
#include "baker/import/scene.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "baker/transport/alpha_map.hpp"

namespace lambent::baker {

// Light is what arrives at surfaces under a sky that is the same all over, as RMS is too dear to tell.
struct SurfaceLook {
  double area = 0.0;     // square metres
  double hidden = 0.0;   // share of the sky's light that the group's surfaces hide
  double bounced = 0.0;  // share of all light that has bounced
};

struct GroupLook {
  SurfaceLook all;
  std::vector<SurfaceLook> draws;  // in the order of the group's
  // Share of all light that has bounced so many times, for 0 to 64 bounces; they add up to 1. Where none of
  // the sky is seen they are those of light that the surfaces themselves give off.
  std::vector<double> passes;
  // Share of the direct light, RMS over real lights, that the bands from each one on carry, of eight.
  std::vector<double> from_band;
  std::uint64_t rays = 0;

  // Returns the share of all light that more than so many bounces bring.
  double after(std::size_t bounces) const;
};

// Returns one entry per group; that of a group without surfaces has no draws. Errors: no memory for the
// hierarchy, images that cannot be decoded.
Result<std::vector<GroupLook>> lookAt(const Scene& scene, const std::vector<RigidGroup>& groups,
                                      const AlphaMaps& alpha_maps, DecodedImages& images);

}  // namespace lambent::baker
