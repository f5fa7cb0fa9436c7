// Holds what passes of bounces bring to glossy samples: the matrices of the last pass and of the next one,
// and the sum of all. Light that a glossy sample receives along d is added to M_p^b as w (y_i(d) +
// y_i(mirrored d)); what leaves it is GlossyExit.
//
// Passes read and add all bands that direct light has, which may be more than ship: the kernel of a sharp
// surface meets shadow edges where light leaves, which few bands cannot represent (docs/design/glossy.md,
// "Bounces"). The sum of the passes has the bands that ship.
//
// Peak memory per sample: the sum (2.5 KB x channels for 5 x 5), and two matrices of all bands (4.9 KB x
// channels each for 7 x 5, 8.1 KB for 9 x 5) including the first pass; while a pass is fitted to points
// inside faces, one more for each of them.
#pragma once

#include <cstddef>
#include <stop_token>
#include <vector>

#include "baker/effects/surface/bounces.hpp"
#include "baker/trace/exit_radiance.hpp"
#include "baker/trace/glossy_exit.hpp"

namespace lambent::baker {

class GlossyPasses {
 public:
  // `light` must outlive this, and has kernels in as many bands as direct light; order_out is at most that.
  GlossyPasses(const LightToBounce& light, int order_out);

  const GlossyExit& exit() const { return exit_; }
  // Gathers one pass, fills and fits it. `now` is the diffuse transfer of all samples; this sets it at glossy
  // ones. The key of the context is that of this pass. Returns false if stopped.
  bool gather(const Bounce& bounce, const SampleEdges& edges, TransferField& now, const BakeContext& context);
  // Makes what was gathered last the input of the next pass.
  void advance();
  // Ends the passes: cuts direct light to order_out bands and moves the sums beside it. Without any pass,
  // `bounced` stays empty, and lights_full is lights_shadowed.
  void finish();

 private:
  GlossyLight zero(int order, std::size_t samples) const;
  // Computes what the pass adds at all glossy samples of a set, which is 0 where these see nothing.
  bool gatherAt(const DirectPass& pass, const DirectResult& direct, const Bounce& bounce, GlossyLight& now,
                const BakeContext& context) const;
  bool fitInside(const Bounce& bounce, const BakeContext& context);
  bool watch(const Bounce& bounce, const BakeContext& context) const;
  // Computes the energies of `state`; if `plain` is not null, also writes diffuse transfer into it and adds
  // the state to the sum. Returns false if stopped.
  bool take(const GlossyLight& state, TransferField* plain, const std::stop_token& stop);
  // Returns the largest ratio over the light sources of what was gathered last to pass 0, at most 1.
  double shareOfBefore() const;

  const LightToBounce& light_;
  std::size_t count_;
  int order_out_;
  GlossyExit exit_;
  GlossyLight now_, sum_;
  std::vector<double> energies_, first_energies_;
};

}  // namespace lambent::baker
