// Interreflection (Sloan 2002, section 4, passes b >= 1). A pass gathers what the pass before left at the
// points that the rays of pass 0 met,
//   t^b_p = sum_rays w_r L_out^(b-1)(q_r),
// with w_r what each ray adds to the outputs of p (hemisphere.hpp), and L_out what leaves q: its albedo,
// which is textured and coloured, times its transfer t, interpolated over the triangle; at glossy points exit
// kernel times matrices (exit_radiance.hpp). All samples gather from the same state of the others (Jacobi),
// so the order of work does not matter; the receiver's own albedo is left out. The first pass is gathered at
// all samples. All later ones are passed on between patches of samples (patches.hpp) until what is still to
// come would add less than asked for, and their sum is gathered at all samples once more: a final gather, in
// place of a gather per pass. A final gather that carries less than a hundredth of all light goes over every
// fourth ray. Where direct light was fitted, both gathers go over the points inside faces too, and what they
// bring to vertices is fitted to these (inside_faces.hpp): in rooms most light bounces, and changes within
// faces.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "baker/effects/surface/direct.hpp"
#include "baker/effects/surface/inside_faces.hpp"
#include "baker/trace/exit_radiance.hpp"

namespace lambent::baker {

struct BounceSettings {
  int bounces = -1;          // -1: as many as tail_error asks for
  double tail_error = 1e-3;  // only with -1: bounds BounceResult::left_out
  int order_out = 5;         // of the matrices of glossy samples, at most that of direct light
};

inline constexpr int kMostBounces = 64;

// Holds what bounces start from.
struct LightToBounce {
  const DirectPass& pass;
  DirectResult& direct;  // of all samples, traced by `pass`; receives what bounces bring to glossy ones, and
                         // is cut to order_out bands there
  const ExitKernels* kernels = nullptr;  // of glossy samples, in as many bands as `direct`; null without
  std::array<const InsideFaces*, 2> fits = {};  // by SurfacePart; null if nothing is fitted
  // Points at which bounces are gathered too, with all of their rays, and fitted to nothing.
  std::vector<TracedPoints*> watched = {};

  const InsideFaces* inside(SurfacePart part) const { return fits[static_cast<std::size_t>(part)]; }
};

struct BounceResult {
  TransferField field, mapped;  // sums of all bounce passes, laid out as those of DirectResult
  // Energy of each pass, starting with pass 0 and relative to it: RMS over a region that eyes see under real
  // lights. It is that of the region and the light (environment or one of the group's) with the largest
  // share.
  std::vector<double> energy;
  double left_out = 0.0;  // estimate of the light of all further passes, relative to all light, likewise
};

// Returns nothing if stopped. Progress shows "bounce 1", "bounce 2", ... The key of the context covers
// everything that the passes read; results of passes are kept under it until dropBounces(), in case the bake
// is cut short.
std::optional<BounceResult> bakeBounces(const LightToBounce& light, const BounceSettings& settings,
                                        const BakeContext& context);
// Removes what bakeBounces() kept. `inside` are the numbers of points inside faces, by SurfacePart.
void dropBounces(const SampleSet& samples, const std::array<std::size_t, 2>& inside,
                 const BakeContext& context);

}  // namespace lambent::baker
