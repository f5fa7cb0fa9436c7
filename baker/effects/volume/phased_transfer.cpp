#include "baker/effects/volume/phased_transfer.hpp"

#include <algorithm>
#include <cmath>

#include "baker/effects/volume/gmres.hpp"
#include "baker/effects/volume/phase_scattering.hpp"
#include "baker/effects/volume/phased_light.hpp"
#include "baker/effects/volume/scatter_light.hpp"
#include "baker/effects/volume/sphere_table.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kRaysPerOutput = 6;
constexpr std::size_t kScatteredPerRange = 64;
// The number of the solver's vectors depends on the size of the system, not on the machine's memory, so that
// results do not either.
constexpr std::uint64_t kSolverBytes = std::uint64_t{1} << 30, kLeastKept = 6, kMostKept = 24;

// Solves x = b + w K x for a block of columns, [sample][output][kBlockColumns], scaled by how much light
// leaves each sample.
class PhasedSystem {
 public:
  PhasedSystem(PhaseScattering& scattering, double albedo, std::stop_token stop)
      : scattering_(scattering),
        albedo_(albedo),
        stop_(std::move(stop)),
        scale_(scattering.samples() * scattering.outputs()) {
    const std::size_t n = scattering.outputs();
    for (std::size_t p = 0; p < scattering.samples(); ++p)
      for (std::size_t i = 0; i < n; ++i) {
        // This computes 1 - w g^l k_pp without subtracting two numbers near 1.
        const double stays = albedo * scattering.factor(i);
        const double kept = 1.0 - stays + stays * scattering.away(p);
        scale_[p * n + i] = 1.0 / std::max(kept, 1e-30);
      }
    const std::uint64_t vector = 4 * scale_.size() * kBlockColumns;
    kept_vectors_ = static_cast<int>(std::clamp(kSolverBytes / vector, kLeastKept, kMostKept));
  }

  GmresResult solve(std::span<const float> first, std::span<float> result) {
    std::vector<float> right(first.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      right[i] = static_cast<float>(double{first[i]} * scale_[i / kBlockColumns]);
    std::copy(right.begin(), right.end(), result.begin());
    return solveGmres(
        right, result,
        [&](std::span<const float> x, std::span<float> y) {
          if (!scattering_.apply(x, y, stop_)) return false;
          const std::size_t n = scattering_.outputs();
          parallelRanges(scale_.size(), kScatteredPerRange * n, {}, [&](std::size_t begin, std::size_t end) {
            for (std::size_t row = begin; row < end; ++row) {
              const double away = scattering_.factor(row % n) * scattering_.away(row / n);
              for (std::size_t i = row * kBlockColumns; i < (row + 1) * kBlockColumns; ++i)
                y[i] = static_cast<float>(albedo_ * scale_[row] * (double{y[i]} + away * double{x[i]}));
            }
          });
          return true;
        },
        {.tolerance = kScatteringTolerance, .restart = kept_vectors_});
  }

  // Computes so many scatterings one after the other.
  GmresResult repeat(std::span<const float> first, std::span<float> result, int times) {
    std::copy(first.begin(), first.end(), result.begin());
    std::vector<float> change(first.size());
    const std::size_t n = scattering_.outputs();
    for (int k = 0; k < times; ++k) {
      if (!scattering_.apply(result, change, stop_)) return {k, 0.0, true};
      for (std::size_t i = 0; i < first.size(); ++i) {
        const double goes_on = scattering_.factor(i / kBlockColumns % n);
        result[i] = static_cast<float>(double{first[i]} +
                                       albedo_ * (goes_on * double{result[i]} + double{change[i]}));
      }
    }
    return {times, 0.0, false};
  }

 private:
  PhaseScattering& scattering_;
  double albedo_;
  std::stop_token stop_;
  std::vector<double> scale_;
  int kept_vectors_ = 0;
};

}  // namespace

bool bakePhasedTransfer(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                        VolumeTransfer& out, const BakeContext& context) {
  const std::size_t samples = out.grid.samples();
  const VolumeScene scene{*medium.density, out.grid, occluders};
  const SphereTable table(settings.rays, out.order + out.bands - 1);
  auto light = findPhasedLight(scene, table, out.bands, context.part("light"));
  if (!light) return false;
  out.rays = light->samples_traced * table.size();
  out.rays_kept = (samples - light->samples_traced) * table.size();
  const sh::GauntTable products = sh::makeGauntTable(out.order, out.bands);
  parallelRanges(samples, kScatteredPerRange, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      sh::addVisibilityMatrix(
          products, std::span(light->visibility).subspan(p * light->visibility_size, light->visibility_size),
          std::span(out.vectors).subspan(p * out.vectorSize(), out.outputs() * out.columns()));
  });
  if (out.bands > 3) out.visibility = std::move(light->visibility);
  if (out.full_channels == 0) return true;

  const SphereTable few(
      std::max({kLeastScatteringRays, kRaysPerOutput * out.outputs(), settings.rays / kRaysPerScatteringRay}),
      out.bands);
  auto scattering = PhaseScattering::build(scene, few, light->clear,
                                           {.bands = out.bands, .g = out.g, .memory = settings.memory},
                                           context.part("rows"));
  if (!scattering) return false;
  out.rays += scattering->samplesTraced() * few.size();
  out.rays_kept += (samples - scattering->samplesTraced()) * few.size();
  out.row_bytes = scattering->bytes();
  const auto system = [&](double albedo) { return PhasedSystem(*scattering, albedo, context.stop); };
  return scatterLight(system, settings, out, context);
}

void dropPhasedParts(const BakeContext& context, std::size_t samples) {
  dropPhasedLight(context.part("light"), samples);
  PhaseScattering::drop(context.part("rows"), samples);
}

}  // namespace lambent::baker
