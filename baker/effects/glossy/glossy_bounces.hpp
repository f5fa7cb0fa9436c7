// Light between matte and glossy surfaces, both ways (Sloan 2002, section 4, passes b >= 1): what leaves a
// glossy point q towards p is c(q, v)^T M_q^(b-1), c its exit kernel; what a glossy sample receives along d
// is added to M_p^b as w (y_i(d) + y_i(mirrored d)). Goes along with bakeBounces as its partner:
//   GlossyBounces glossy(pass, kernels, direct, glossy_direct);
//   bakeBounces(plain_pass, direct, scene, settings, progress, stop, &glossy);
//   glossy.finish();   // glossy_direct.field has `bounced` and `lights_full`
// Memory at its most: three times `bounced` (2.5 KB x channels per sample for 5 x 5).
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
  // All outlive this. `kernels` answer for the triangles of glossy draws.
  GlossyBounces(const GlossyPass& pass, const ExitKernels& kernels, const DirectResult& plain,
                GlossyDirect& direct);

  void addExit(const GatherHit& hit, const glm::uvec3& corners, const glm::vec3& to, float chance,
               float weight, std::span<float> sum) const override;
  bool gather(int bounce, bool thinly, const ExitRadiance& exit, const TransferField& before,
              TransferField& now, Progress& progress, const std::stop_token& stop, const Keep& keep) override;
  void advance() override;
  std::vector<double> energies() const override { return energies_; }

  // After the passes: moves their sums into the field. Without a pass `bounced` stays empty, and lights_full
  // is lights_shadowed.
  void finish();

 private:
  class Walk;
  // Of the environment, and of the lights of the group.
  struct State {
    GlossyMatrices environment, lights;
  };
  State zero() const;
  // What follows from `state`: its energies, and where asked for plain transfer in `plain` and the sum so
  // far.
  bool take(const State& state, TransferField* plain, const std::stop_token& stop);

  // Largest share over the sources of light that what was gathered last has of pass 0; 1 where that had none.
  double shareOfBefore() const;

  const GlossyPass& pass_;
  const ExitKernels& kernels_;
  const DirectResult& plain_;
  GlossyDirect& direct_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;  // empty where no sample is filled
  State before_, now_, sum_;
  std::vector<double> energies_, first_energies_;
};

}  // namespace lambent::baker
