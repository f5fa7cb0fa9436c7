// Computes the light that reaches a volume's samples unscattered, by direction: the transmittance tau(s)
// through the medium and past the surfaces, as spherical harmonics. With incident light l, the coefficients
//   L_i = sum_jk Gamma_ijk tau_k l_j
// arrive. This is exact with tau in order + bands - 1 bands (literature 1.9).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "baker/effects/volume/sphere_table.hpp"
#include "baker/effects/volume/volume_scene.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

struct PhasedLight {
  std::size_t visibility_size = 0;
  std::vector<float> visibility;   // [sample][visibility_size]: tau_k = int tau y_k ds
  std::vector<float> clear;        // [sample][bands²]: the same through the medium alone, up to the surfaces
  std::size_t samples_traced = 0;  // in this run; the others were found in the cache
};

// `table` has order + bands - 1 bands. Returns nothing if stopped.
std::optional<PhasedLight> findPhasedLight(const VolumeScene& scene, const SphereTable& table, int bands,
                                           const BakeContext& context);
// Removes what findPhasedLight() kept.
void dropPhasedLight(const BakeContext& context, std::size_t samples);

}  // namespace lambent::baker
