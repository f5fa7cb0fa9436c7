// Interreflection (Sloan 2002, section 4, passes b >= 1). A pass gathers what the pass before left at the
// points that the rays of pass 0 met,
//   t^b_p = sum_rays w_r rho(q_r) t^(b-1)(q_r),   t(q) interpolated over the triangle that was met,
// all samples from the same state of the others (Jacobi), so the order of work does not matter. The first
// pass is gathered at all samples. All later ones are passed on between patches of samples (patches.hpp)
// until what is still to come would add less than asked for, and their sum is gathered at all samples once
// more: a final gather, in place of a gather per pass. The surface's albedo rho is textured and coloured; the
// receiver's own is left out. A final gather that carries less than a hundredth of all light goes over every
// fourth ray. Where direct light was fitted, both gathers go over the points inside faces too, and what they
// bring to vertices is fitted to these (traced_points.hpp): in rooms most light bounces, and changes within
// faces.
#pragma once

#include <optional>
#include <vector>

#include "baker/effects/diffuse/direct.hpp"
#include "baker/trace/exit_radiance.hpp"

namespace lambent::baker {

struct BounceSettings {
  int bounces = -1;          // -1: as many as tail_error asks for
  double tail_error = 1e-3;  // only with -1: bounds BounceResult::left_out
};

inline constexpr int kMostBounces = 64;

struct BounceResult {
  TransferField field, mapped;  // sums of all bounce passes, laid out as those of DirectResult
  // Energy of each pass, starting with pass 0 and relative to it: RMS over a region that eyes see under real
  // lights. It is that of the region and the light (environment or one of the group's) with the largest
  // share.
  std::vector<double> energy;
  double left_out = 0.0;  // estimate of the light of all further passes, relative to all light, likewise
  std::vector<TransferField> at_watched = {};  // what all passes bring to DirectResult::watched
};

// Returns nothing if stopped. Progress shows "bounce 1", "bounce 2", ... `partner` may be null. The key of
// the context covers everything that the passes read; results of passes are kept under it until
// dropBounces(), in case the bake is cut short.
std::optional<BounceResult> bakeBounces(const DirectPass& pass, const DirectResult& direct,
                                        const TracedScene& scene, const BounceSettings& settings,
                                        const BakeContext& context, BouncePartner* partner = nullptr);
// Removes what bakeBounces() kept. The numbers of points inside faces are its own and the partner's.
void dropBounces(const TracedScene& scene, std::size_t inside_diffuse, std::size_t inside_glossy,
                 const BakeContext& context);

}  // namespace lambent::baker
