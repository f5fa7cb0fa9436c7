#include "baker/effects/volume/volume_transfer.hpp"

#include <algorithm>
#include <cmath>

#include "baker/effects/volume/gmres.hpp"
#include "baker/effects/volume/phased_transfer.hpp"
#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/effects/volume/sphere_table.hpp"
#include "baker/work/parallel.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kRaysPerScatteringRay = 4, kLeastScatteringRays = 64;
constexpr std::size_t kGrain = 16;
constexpr double kTolerance = 1e-5;
// Light that is scattered ten million times and never absorbed has no number: without this the system of a
// medium that nothing gets out of is singular.
constexpr double kLargestAlbedo = 1.0 - 1e-7;
constexpr double kY0 = 0.28209479177387814;

// What arrives unscattered, and what stands in its way.
struct FirstLight {
  std::vector<float> transfer;   // [sample][order²]
  std::vector<double> met, out;  // share of the directions whose light the medium meets, and the rest
};

bool lightIn(const Medium& medium, const TransferGrid& grid, const Occluders& occluders,
             const SphereTable& table, std::size_t columns, FirstLight& light, Progress& progress,
             const std::stop_token& stop) {
  light.transfer.resize(grid.samples() * columns);
  light.met.resize(grid.samples());
  light.out.resize(grid.samples());
  return parallelRanges(grid.samples(), kGrain, stop, [&](std::size_t begin, std::size_t end) {
    std::vector<float> reach(table.size());
    std::vector<double> lost(columns);
    for (std::size_t p = begin; p < end; ++p) {
      const glm::vec3 origin = grid.place(p);
      occluders.reach(origin, table.directions(), reach);
      std::fill(lost.begin(), lost.end(), 0.0);
      double met = 0.0, out = 0.0, open = 0.0;
      for (std::size_t r = 0; r < table.size(); ++r) {
        const double depth = double{medium.density->opticalDepth(origin, table.direction(r), reach[r])};
        const double clear = std::exp(-depth), gone = -std::expm1(-depth);
        met += gone;
        out += clear;
        const bool blocked = std::isfinite(reach[r]);
        const double missing = blocked ? 1.0 : gone;
        open += blocked ? 0.0 : clear;
        const auto y = table.harmonics(r);
        for (std::size_t i = 0; i < columns; ++i) lost[i] += missing * double{y[i]};
      }
      const double share = 1.0 / static_cast<double>(table.size());
      light.met[p] = met * share;
      light.out[p] = out * share;
      // Off the closed form of an open sky (y_0, then zeros), so that thin air is exact; the sums of y_i over
      // the table, nearly 0, are put right for thick air.
      open *= share;
      for (std::size_t i = 0; i < columns; ++i)
        light.transfer[p * columns + i] =
            static_cast<float>(i == 0 ? kY0 * open : (1.0 - open) * table.mean(i) - lost[i] * share);
    }
    progress.add(end - begin);
  });
}

// T = T0 + w K T for a block of columns, on the diagonal's scale: what a sample keeps to itself is taken out
// of the iteration, so that thick media converge too. result, first: [sample][kBlockColumns].
class Scattering {
 public:
  Scattering(const ScatterRows& rows, const TransferGrid& grid, const FirstLight& light, double albedo,
             const std::stop_token& stop)
      : rows_(rows),
        albedo_(albedo),
        stop_(stop),
        nodes_(grid.nodes() * kBlockColumns),
        scale_(rows.samples()) {
    for (std::size_t p = 0; p < scale_.size(); ++p) {
      // 1 - w k_pp without the difference of two numbers near 1.
      const double kept = 1.0 - albedo + albedo * (rows.others(p) + light.out[p]);
      scale_[p] = kept > 1e-30 ? 1.0 / kept : 0.0;
    }
  }

  GmresResult solve(std::span<const float> first, std::span<float> result) {
    std::vector<float> right(first.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      right[i] = static_cast<float>(double{first[i]} * scale_[i / kBlockColumns]);
    std::copy(right.begin(), right.end(), result.begin());
    return solveGmres(right, result,
                      [&](std::span<const float> x, std::span<float> y) {
                        std::copy(x.begin(), x.end(), nodes_.begin());
                        if (!rows_.apply(nodes_, y, stop_)) return false;
                        for (std::size_t i = 0; i < y.size(); ++i)
                          y[i] = static_cast<float>(albedo_ * scale_[i / kBlockColumns] * double{y[i]});
                        return true;
                      },
                      {.tolerance = kTolerance});
  }

  // So many scatterings one after the other.
  GmresResult repeat(std::span<const float> first, std::span<float> result, int times) {
    std::copy(first.begin(), first.end(), result.begin());
    std::vector<float> others(first.size());
    for (int k = 0; k < times; ++k) {
      std::copy(result.begin(), result.end(), nodes_.begin());
      if (!rows_.apply(nodes_, others, stop_)) return {k, 0.0, true};
      for (std::size_t i = 0; i < first.size(); ++i)
        result[i] = static_cast<float>(
            double{first[i]} +
            albedo_ * (rows_.self(i / kBlockColumns) * double{result[i]} + double{others[i]}));
    }
    return {times, 0.0, false};
  }

 private:
  const ScatterRows& rows_;
  double albedo_;
  const std::stop_token& stop_;
  std::vector<float> nodes_;
  std::vector<double> scale_;
};

bool scatter(const ScatterRows& rows, const FirstLight& light, const VolumeSettings& settings,
             VolumeTransfer& out, Progress& progress, const std::stop_token& stop) {
  const std::size_t columns = out.columns(), samples = out.grid.samples();
  std::vector<float> first(samples * kBlockColumns), result(first.size());
  for (std::size_t block = 0; block < columns; block += kBlockColumns) {
    const std::size_t width = std::min(kBlockColumns, columns - block);
    std::fill(first.begin(), first.end(), 0.0f);
    for (std::size_t p = 0; p < samples; ++p)
      std::copy_n(&light.transfer[p * columns + block], width, &first[p * kBlockColumns]);
    for (std::uint32_t channel = 0; channel < out.full_channels; ++channel) {
      const double albedo = std::min(double{out.albedo[static_cast<int>(channel)]}, kLargestAlbedo);
      Scattering scattering(rows, out.grid, light, albedo, stop);
      const GmresResult done = settings.scatterings < 0
                                   ? scattering.solve(first, result)
                                   : scattering.repeat(first, result, settings.scatterings);
      if (done.stopped) return false;
      out.iterations = std::max(out.iterations, done.iterations);
      out.residual = std::max(out.residual, done.residual);
      for (std::size_t p = 0; p < samples; ++p)
        std::copy_n(&result[p * kBlockColumns], width,
                    &out.vectors[p * out.vectorSize() + (1 + channel) * columns + block]);
      progress.add(width);
    }
  }
  return true;
}

}  // namespace

std::optional<VolumeTransfer> bakeVolumeTransfer(const Medium& medium, const VolumeSettings& settings,
                                                 const Occluders& occluders, Progress& progress,
                                                 const std::stop_token& stop) {
  const glm::vec3& w = medium.albedo;
  const bool black = w == glm::vec3(0.0f), grey = w.r == w.g && w.g == w.b;
  VolumeTransfer out{.density = medium.density,
                     .grid = TransferGrid(*medium.density, medium.values, settings.grid),
                     .albedo = w,
                     .order = settings.order,
                     .g = medium.g,
                     .bands = bandsOfPhase(medium.g, settings.order),
                     .full_channels = settings.scatterings == 0 || black ? 0u
                                      : grey                             ? 1u
                                                                         : 3u,
                     .vectors = {},
                     .visibility = {}};
  const std::size_t samples = out.grid.samples(), columns = out.columns();
  out.vectors.resize(samples * out.vectorSize());
  if (samples == 0) return out;
  if (out.bands > 1) {
    if (!bakePhasedTransfer(medium, settings, occluders, out, progress, stop)) return std::nullopt;
    return out;
  }

  const SphereTable table(settings.rays, settings.order);
  progress.begin("light into volumes", samples, "samples");
  FirstLight light;
  if (!lightIn(medium, out.grid, occluders, table, columns, light, progress, stop)) return std::nullopt;
  out.rays = samples * table.size();
  for (std::size_t p = 0; p < samples; ++p)
    std::copy_n(&light.transfer[p * columns], columns, &out.vectors[p * out.vectorSize()]);
  if (out.full_channels == 0) return out;

  const SphereTable few(std::max(kLeastScatteringRays, settings.rays / kRaysPerScatteringRay), 1);
  progress.begin("scattering", samples, "samples");
  const auto rows = ScatterRows::build(*medium.density, out.grid, occluders, few, light.met, settings.memory,
                                       progress, stop);
  if (!rows) return std::nullopt;
  out.rays += samples * few.size();
  out.row_bytes = rows->bytes();
  progress.begin("scattered light", columns * out.full_channels, "columns");
  if (!scatter(*rows, light, settings, out, progress, stop)) return std::nullopt;
  return out;
}

}  // namespace lambent::baker
