// Light between diffuse and glossy surfaces, both ways (Sloan 2002, section 4, passes b >= 1): what leaves a
// glossy point q towards p is c(q, v)^T M_q^(b-1), c its exit kernel; what a glossy sample receives along d
// is added to M_p^b as w (y_i(d) + y_i(mirrored d)). Goes along with bakeBounces as its partner:
//   GlossyBounces glossy(pass, kernels, direct, glossy_direct, order_out);
//   bakeBounces(diffuse_pass, direct, scene, settings, context, &glossy);
//   glossy.finish();   // glossy_direct.field has `bounced` and `lights_full`, all of order_out bands
// Passes bring and take all bands that `direct` has, which may be more than order_out: the kernel of a sharp
// surface meets edges of shadows where light leaves, which few bands do not have (docs/decisions/glossy.md,
// "Bounces"). Their sum has order_out bands. Where direct light was fitted to points inside faces, what each
// pass brings is fitted to what it brings there, before the next one begins. Memory at its most: `bounced`
// (2.5 KB x channels per sample for 5 x 5), and twice a matrix of all bands (4.9 KB x channels for 7 x 5, 8.1
// for 9 x 5) for each sample, the first pass included; and one for each of the points inside faces while a
// pass is fitted to them.
#pragma once

#include "baker/effects/diffuse/bounces.hpp"
#include "baker/effects/glossy/exit_kernels.hpp"
#include "baker/effects/glossy/glossy_direct.hpp"

namespace lambent::baker {

// Of all glossy samples: [sample][channel][output][column].
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
  // Of a channel, or the one that stands for all.
  std::span<const float> matrix(std::size_t sample, std::size_t channel) const {
    return at(sample).subspan((channels == 1 ? 0 : channel) * matrixSize(), matrixSize());
  }
};

class GlossyBounces : public BouncePartner {
 public:
  // All outlive this. `kernels` answer for the triangles of glossy draws, in as many bands as `direct` has;
  // order_out: at most as many.
  GlossyBounces(const GlossyPass& pass, const ExitKernels& kernels, const DirectResult& plain,
                GlossyDirect& direct, int order_out);

  void addExit(const GatherHit& hit, const glm::uvec3& corners, const glm::vec3& to, float chance,
               float weight, std::span<float> sum) const override;
  glm::vec3 albedo(const GatherHit& hit, const glm::vec3& to) const override;
  void visitHits(std::size_t sample, const TakeGlossyHit& take) const override;
  bool gather(const Bounce& bounce, TransferField& now, const BakeContext& context) override;
  void advance() override;
  std::vector<double> energies() const override { return energies_; }

  // After the passes: cuts the field to order_out bands and moves their sums into it. Without a pass
  // `bounced` stays empty, and lights_full is lights_shadowed.
  void finish();

 private:
  class Walk;
  // Where it gathers, and what the rays met there.
  struct Receivers {
    const GlossyPass& pass;
    const HitStore& hits;
    const SampleVisibilities& looks;
  };
  // Of the environment, and of the lights of the group.
  struct State {
    GlossyMatrices environment, lights;
  };
  // Of `order` bands.
  State zero(int order, std::size_t samples) const;
  // What the pass brings to all samples of `at`; 0 where these see nothing. False if stopped.
  bool gatherAt(const Receivers& at, const Bounce& bounce, State& now, const BakeContext& context) const;
  // now_ is fitted to what it brings to the points inside faces.
  bool fitInside(const Bounce& bounce, const BakeContext& context);
  // What follows from `state`: its energies, and where asked for plain transfer in `plain` and the sum so
  // far.
  bool take(const State& state, TransferField* plain, const std::stop_token& stop);

  // Largest share over the sources of light that what was gathered last has of pass 0; 1 where that had none.
  double shareOfBefore() const;

  const GlossyPass& pass_;
  const ExitKernels& kernels_;
  const DirectResult& diffuse_;
  GlossyDirect& direct_;
  int order_out_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;  // empty where no sample is filled
  State before_, now_, sum_;
  std::vector<double> energies_, first_energies_;
};

}  // namespace lambent::baker
