// Light that reaches a volume's samples unscattered, direction by direction: the share tau(s) that comes
// through the medium and past the surfaces, as spherical harmonics. Of light l the coefficients
//   L_i = sum_jk Gamma_ijk tau_k l_j
// arrive, exactly, with tau in order + bands - 1 bands (literature 1.9).
#pragma once

#include <cstddef>
#include <stop_token>
#include <vector>

#include "baker/cache/cached_ranges.hpp"
#include "baker/effects/volume/density_field.hpp"
#include "baker/effects/volume/occluders.hpp"
#include "baker/effects/volume/sphere_table.hpp"
#include "baker/effects/volume/transfer_grid.hpp"
#include "baker/jobs/progress.hpp"

namespace lambent::baker {

struct PhasedLight {
  std::size_t visibility_size = 0;
  std::vector<float> visibility;   // [sample][visibility_size]: tau_k = int tau y_k ds
  std::vector<float> clear;        // [sample][bands²]: the same of the medium alone, up to the surfaces
  std::size_t samples_traced = 0;  // in this run; the others were kept
};

// table: of order + bands - 1 bands. False if stopped.
bool findPhasedLight(const DensityField& density, const TransferGrid& grid, const Occluders& occluders,
                     const SphereTable& table, int bands, PhasedLight& light, Progress& progress,
                     const std::stop_token& stop, const Keep& keep = {});
// What it kept.
void dropPhasedLight(const Keep& keep, std::size_t samples);

}  // namespace lambent::baker
