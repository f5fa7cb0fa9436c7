// Describes to light transport how glossy surfaces reflect: L_out(q -> v) = Σ_k c_k(v) l'_k
// (surface_brdfs.hpp). Kernels are passed in as a function, so that the passes know no materials.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include <glm/vec3.hpp>

#include "baker/effects/diffuse/bounces.hpp"
#include "baker/effects/glossy/glossy_direct.hpp"

namespace lambent::baker {

struct ExitKernels {
  bool grey = true;  // red, green and blue are the same
  // Computes the kernel towards the unit direction `to` (group frame, away from the surface) of the point
  // with barycentric weights u, v of corners 1 and 2: out[channel * order_out² + k], three channels, of at
  // most as many bands as the surfaces have. May be called from any thread.
  std::function<void(std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out)> at;
};

// Computes light between diffuse and glossy surfaces, both ways (Sloan 2002, section 4, passes b >= 1). The
// light that leaves a glossy point q towards p is c(q, v)^T M_q^(b-1), with c the exit kernel of q; light
// that a glossy sample receives along d is added to M_p^b as w (y_i(d) + y_i(mirrored d)). A GlossyBounces is
// the partner of bakeBounces:
//   GlossyBounces glossy(pass, kernels, direct, glossy_direct, order_out);
//   bakeBounces(diffuse_pass, direct, scene, settings, context, &glossy);
//   glossy.finish();   // glossy_direct.field has `bounced` and `lights_full`, all of order_out bands
// Passes read and add all bands that `direct` has, which may be more than order_out: the kernel of a sharp
// surface meets shadow edges where light leaves, which few bands cannot represent (docs/design/glossy.md,
// "Bounces"). The sum of the passes has order_out bands. If direct light was fitted to points inside faces,
// each pass is fitted to what it adds there before the next one begins.
//
// Peak memory per sample: `bounced` (2.5 KB x channels for 5 x 5), and two matrices of all bands (4.9 KB x
// channels each for 7 x 5, 8.1 KB for 9 x 5) including the first pass; while a pass is fitted to points
// inside faces, one more for each of them.

// GlossyMatrices are the matrices of all glossy samples: [sample][channel][output][column].
struct GlossyMatrices {
  std::size_t channels = 1, outputs = 25, columns = 25;
  std::vector<float> values;

  std::size_t matrixSize() const { return outputs * columns; }
  std::size_t sampleSize() const { return channels * matrixSize(); }
  std::span<float> at(std::size_t sample) {
    return std::span(values).subspan(sample * sampleSize(), sampleSize());
  }
  std::span<const float> at(std::size_t sample) const {
    return std::span(values).subspan(sample * sampleSize(), sampleSize());
  }
  // Returns the matrix of a channel, or the only one if all channels share it.
  std::span<const float> matrix(std::size_t sample, std::size_t channel) const {
    return at(sample).subspan((channels == 1 ? 0 : channel) * matrixSize(), matrixSize());
  }
};

class GlossyBounces : public BouncePartner {
 public:
  // All arguments must outlive this. `kernels` cover the triangles of glossy draws, in as many bands as
  // `direct` has; order_out is at most that.
  GlossyBounces(const GlossyPass& pass, const ExitKernels& kernels, const DirectResult& plain,
                GlossyDirect& direct, int order_out);

  glm::vec3 addExit(const GatherHit& hit, const glm::uvec3& corners, const glm::vec3& to, float chance,
                    float weight, std::span<float> sum) const override;
  glm::vec3 albedo(const GatherHit& hit, const glm::vec3& to) const override;
  void visitHits(std::size_t sample, const ExitRadiance& exit, const TakeHit& take) const override;
  bool gather(const Bounce& bounce, TransferField& now, const BakeContext& context) override;
  void advance() override;

  // Ends the passes: cuts the field to order_out bands and moves their sums into it. Without any pass,
  // `bounced` stays empty, and lights_full is lights_shadowed.
  void finish();

 private:
  class Walk;
  // Receivers are samples that gather, and the hits of their rays.
  struct Receivers {
    const GlossyPass& pass;
    const HitStore& hits;
    const SampleVisibilities& looks;
  };
  // A State is the light of one pass, of the environment and of the group's lights.
  struct State {
    GlossyMatrices environment, lights;
  };
  // Returns a state of zeros with `order` bands.
  State zero(int order, std::size_t samples) const;
  // Computes what the pass adds at all samples of `at`, which is 0 where these see nothing. Returns false if
  // stopped.
  bool gatherAt(const Receivers& at, const Bounce& bounce, State& now, const BakeContext& context) const;
  // Fits now_ to what the pass adds at the points inside faces.
  bool fitInside(const Bounce& bounce, const BakeContext& context);
  // Adds what the pass brings to the watched points. Returns false if stopped.
  bool watch(const Bounce& bounce, const BakeContext& context) const;
  // Computes the energies of `state`; if `plain` is not null, also writes diffuse transfer into it and adds
  // the state to the sum. Returns false if stopped.
  bool take(const State& state, TransferField* plain, const std::stop_token& stop);

  // Returns the largest ratio over the light sources of what was gathered last to pass 0, at most 1.
  double shareOfBefore() const;

  const GlossyPass& pass_;
  const ExitKernels& kernels_;
  const DirectResult& diffuse_;
  GlossyDirect& direct_;
  int order_out_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;  // empty if no sample is filled
  State before_, now_, sum_;
  std::vector<double> energies_, first_energies_;
};

}  // namespace lambent::baker
