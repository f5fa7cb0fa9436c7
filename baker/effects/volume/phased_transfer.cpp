#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "baker/effects/volume/first_light.hpp"
#include "baker/effects/volume/gmres.hpp"
#include "baker/effects/volume/phase_scattering.hpp"
#include "baker/effects/volume/ray_steps.hpp"
#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

namespace {

// Computes the light that reaches a volume's samples unscattered, by direction: the transmittance tau(s)
// through the medium and past the surfaces, as spherical harmonics. With incident light l, the coefficients
//   L_i = sum_jk Gamma_ijk tau_k l_j
// arrive. This is exact with tau in order + bands - 1 bands (literature 1.9).

struct PhasedLight {
  std::size_t visibility_size = 0;
  std::vector<float> visibility;   // [sample][visibility_size]: tau_k = int tau y_k ds
  std::vector<float> clear;        // [sample][bands²]: the same through the medium alone, up to the surfaces
  std::size_t samples_traced = 0;  // in this run; the others were found in the cache
};

constexpr std::size_t kLightPerRange = 16;

// Computes int f y_i ds of a function f with the mean `mean`, where `lost` are the sums of (1 - f) y_i over
// the table. Losses are taken off the closed form of f = 1, so that thin air is exact; the sums of y_i over
// the table, which are nearly 0, are corrected for thick air.
void project(const SphereTable& table, double mean, std::span<const double> lost, std::span<float> out) {
  const double share = 1.0 / static_cast<double>(table.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<float>(
        4.0 * std::numbers::pi *
        (i == 0 ? kMeanOfBandZero * mean : (1.0 - mean) * table.mean(i) - lost[i] * share));
}

void findLight(const VolumeScene& scene, const SphereTable& table, std::size_t begin, std::size_t end,
               PhasedLight& light) {
  const auto& [density, grid, occluders] = scene;
  const std::size_t size = light.visibility_size, outputs = light.clear.size() / grid.samples();
  std::vector<float> reach(table.size());
  std::vector<double> lost(size), gone_sums(outputs);
  for (std::size_t p = begin; p < end; ++p) {
    const glm::vec3 origin = grid.place(p);
    occluders.reach(origin, table.directions(), reach);
    std::fill(lost.begin(), lost.end(), 0.0);
    std::fill(gone_sums.begin(), gone_sums.end(), 0.0);
    double open = 0.0, clear = 0.0;
    for (std::size_t r = 0; r < table.size(); ++r) {
      const double depth = double{density.opticalDepth(origin, table.direction(r), reach[r])};
      const double through = std::exp(-depth), gone = -std::expm1(-depth);
      const bool blocked = std::isfinite(reach[r]);
      const double missing = blocked ? 1.0 : gone;
      open += blocked ? 0.0 : through;
      clear += through;
      const auto y = table.harmonics(r);
      for (std::size_t i = 0; i < size; ++i) lost[i] += missing * double{y[i]};
      for (std::size_t i = 0; i < outputs; ++i) gone_sums[i] += gone * double{y[i]};
    }
    const double share = 1.0 / static_cast<double>(table.size());
    project(table, open * share, lost, std::span(light.visibility).subspan(p * size, size));
    project(table, clear * share, gone_sums, std::span(light.clear).subspan(p * outputs, outputs));
  }
}

// `table` has order + bands - 1 bands. Returns nothing if stopped.
std::optional<PhasedLight> findPhasedLight(const VolumeScene& scene, const SphereTable& table, int bands,
                                           const BakeContext& context) {
  const std::size_t samples = scene.grid.samples(), size = table.harmonics(0).size();
  const auto outputs = static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
  PhasedLight light{.visibility_size = size,
                    .visibility = std::vector<float>(samples * size),
                    .clear = std::vector<float>(samples * outputs)};
  const auto compute = [&](std::size_t begin, std::size_t end) {
    findLight(scene, table, begin, end, light);
  };
  const auto done = runStage({.name = "light into volumes",
                              .count = samples,
                              .grain = kLightPerRange,
                              .writes = {rowsOf(light.visibility, size), rowsOf(light.clear, outputs)},
                              .compute = compute},
                             context);
  if (!done) return std::nullopt;
  light.samples_traced = done->computed;
  return light;
}

// Removes what findPhasedLight() kept.
void dropPhasedLight(const BakeContext& context, std::size_t samples) {
  dropStage(context, samples, kLightPerRange);
}

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
