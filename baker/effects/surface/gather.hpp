// Gathers one pass of bounces at traced samples: what the pass before left at the points that their rays met.
// What each ray brings is added to the outputs that its hemisphere lists (hemisphere.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "baker/effects/surface/bounces.hpp"
#include "baker/effects/surface/direct.hpp"
#include "baker/trace/exit_radiance.hpp"
#include "baker/trace/patches.hpp"

namespace lambent::baker {

class BounceGather {
 public:
  // `direct` was traced by `pass`; `exit` is that of the surfaces that are met. All must outlive this.
  BounceGather(const DirectPass& pass, const DirectResult& direct, const ExitRadiance& exit)
      : pass_(pass), direct_(direct), exit_(exit) {}

  // Calls `take` with the hits of a sample, their weights and albedos.
  void visitHits(std::size_t sample, const TakeHit& take) const;

  // Gathers at diffuse and normal-mapped samples [begin, end). Adds to `mapped`, which is in the group's
  // frame.
  void matte(const Bounce& bounce, std::size_t begin, std::size_t end, TransferField& now,
             TransferField& mapped) const;

  // Gathers at glossy samples [begin, end), counted from the first. `share` is the largest share of all light
  // that the pass carries.
  void glossy(const Bounce& bounce, double share, std::size_t begin, std::size_t end, GlossyLight& now) const;

 private:
  class GlossyWalk;
  struct Received;
  void gatherMapped(std::size_t sample, const Received& received, std::span<float> out,
                    std::span<float> mapped) const;
  const Hemisphere& hemisphereOf(std::size_t sample) const {
    return pass_.hemisphereOf(sample, direct_.looks.ray_counts[sample]);
  }
  glm::vec3 normalOf(std::size_t sample) const { return pass_.scene().samples.normals[sample]; }

  const DirectPass& pass_;
  const DirectResult& direct_;
  const ExitRadiance& exit_;
};

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

class GlossyPasses {
 public:
  // `light` must outlive this, and has kernels in as many bands as direct light; order_out is at most that.
  GlossyPasses(const LightToBounce& light, int order_out);

  const GlossyExit& exit() const { return exit_; }
  // Gathers one pass, fills and fits it, and adds what it brings to watched points. `now` is the diffuse
  // transfer of all samples; this sets it at glossy ones. The key of the context is that of this pass.
  // Returns false if stopped.
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
