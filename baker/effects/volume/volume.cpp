#include "baker/effects/volume/volume.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/effects/volume/first_light.hpp"
#include "baker/effects/volume/fit_within_voxels.hpp"
#include "baker/effects/volume/gmres.hpp"
#include "baker/effects/volume/phase_scattering.hpp"
#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/plan/counted.hpp"

namespace lambent::baker {

EffectChoice chooseVolume(const Scene& scene, const std::vector<RigidGroup>&) {
  if (scene.volumes.empty()) return {"volume", false, "no node has a volume"};
  std::vector<std::string> each;
  for (const SceneVolume& volume : scene.volumes) {
    const glm::vec3& w = volume.albedo;
    const bool grey = w.r == w.g && w.g == w.b;
    each.push_back(fmt::format(
        "{} ({} x {} x {} voxels, albedo {})", volume.name, volume.size.x, volume.size.y, volume.size.z,
        grey ? fmt::format("{:.3g}", double{w.r})
             : fmt::format("{:.3g} {:.3g} {:.3g}", double{w.r}, double{w.g}, double{w.b})));
  }
  return {"volume", true,
          fmt::format("{}, light that comes through and that is scattered: {}",
                      counted(scene.volumes.size(), "volume"), fmt::join(each, "; "))};
}

namespace {

constexpr std::size_t kSamplesPerRange = 16;

// FirstLights hold the light that arrives unscattered, and how much the medium takes.
struct FirstLights {
  std::vector<float> transfer;     // [sample][order²]
  std::vector<double> met, out;    // [sample], as in Arrival
  std::size_t samples_traced = 0;  // in this run; the others were found in the cache
};

std::optional<FirstLights> lightIn(const VolumeScene& scene, const SphereTable& table, std::size_t columns,
                                   const BakeContext& context) {
  const std::size_t samples = scene.grid.samples();
  FirstLights light{.transfer = std::vector<float>(samples * columns),
                    .met = std::vector<double>(samples),
                    .out = std::vector<double>(samples)};
  const auto compute = [&](std::size_t begin, std::size_t end) {
    FirstLight first(scene.density, scene.occluders);
    for (std::size_t p = begin; p < end; ++p) {
      const auto transfer = std::span(light.transfer).subspan(p * columns, columns);
      const Arrival arrival = first.look(scene.grid.place(p), table, transfer);
      light.met[p] = arrival.met;
      light.out[p] = arrival.out;
    }
  };
  const auto done =
      runStage({.name = "light into volumes",
                .count = samples,
                .grain = kSamplesPerRange,
                .writes = {rowsOf(light.transfer, columns), rowsOf(light.met), rowsOf(light.out)},
                .compute = compute},
               context);
  if (!done) return std::nullopt;
  light.samples_traced = done->computed;
  return light;
}

// Solves T = T0 + w K T for a block of columns, scaled by the diagonal: the light that a sample sends to
// itself is taken out of the iteration, so that thick media converge too. `result` and `first` are
// [sample][kBlockColumns].
class Scattering {
 public:
  Scattering(const ScatterRows& rows, const TransferGrid& grid, const FirstLights& light, double albedo,
             std::stop_token stop)
      : rows_(rows),
        albedo_(albedo),
        stop_(std::move(stop)),
        nodes_(grid.nodes() * kBlockColumns),
        scale_(rows.samples()) {
    for (std::size_t p = 0; p < scale_.size(); ++p) {
      // This computes 1 - w k_pp without subtracting two numbers near 1.
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
                      {.tolerance = kScatteringTolerance});
  }

  // Computes so many scatterings one after the other.
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
  std::stop_token stop_;
  std::vector<float> nodes_;
  std::vector<double> scale_;
};

// Removes the checkpoints, once all parts are complete.
void dropParts(const BakeContext& context, const VolumeTransfer& transfer) {
  if (!context.keeps()) return;
  const std::size_t samples = transfer.grid.samples();
  if (transfer.bands > 1) {
    dropPhasedParts(context, samples);
  } else {
    dropStage(context.part("light"), samples, kSamplesPerRange);
    ScatterRows::drop(context.part("rows"), samples);
    dropWithinVoxels(context.part("within voxels"), *transfer.density, transfer.grid);
  }
  for (std::size_t block = 0; block < transfer.columns(); block += kBlockColumns)
    for (std::uint32_t channel = 0; channel < transfer.full_channels; ++channel)
      dropValue(context.part("block", block, channel).part("solved"));
}

bool bakeTransfer(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                  VolumeTransfer& out, const BakeContext& context) {
  const std::size_t samples = out.grid.samples(), columns = out.columns();
  out.rays_kept = 0, out.visibility.clear();
  out.vectors.assign(samples * out.vectorSize(), 0.0f);
  if (samples == 0) return true;
  if (out.bands > 1) return bakePhasedTransfer(medium, settings, occluders, out, context);

  const VolumeScene scene{*medium.density, out.grid, occluders};
  const SphereTable table(settings.rays, settings.order);
  const auto light = lightIn(scene, table, columns, context.part("light"));
  if (!light) return false;
  out.rays = light->samples_traced * table.size();
  out.rays_kept = samples * table.size() - out.rays;
  for (std::size_t p = 0; p < samples; ++p)
    std::copy_n(&light->transfer[p * columns], columns, &out.vectors[p * out.vectorSize()]);
  const auto fit = [&](const ScatterRows* rows) {
    return !settings.fit_within_voxels ||
           fitWithinVoxels(medium, settings, occluders, rows, out, context.part("within voxels"));
  };
  if (out.full_channels == 0) return fit(nullptr);

  const SphereTable few(std::max(kLeastScatteringRays, settings.rays / kRaysPerScatteringRay), 1);
  const auto rows = ScatterRows::build(scene, few, light->met, settings.memory, context.part("rows"));
  if (!rows) return false;
  out.rays += rows->samplesTraced() * few.size();
  out.rays_kept += (samples - rows->samplesTraced()) * few.size();
  out.row_bytes = rows->bytes();
  const auto system = [&](double albedo) {
    return Scattering(*rows, out.grid, *light, albedo, context.stop);
  };
  return scatterLight(system, settings, out, context) && fit(&*rows);
}

}  // namespace

void write(const VolumeTransfer& transfer, ByteWriter& out) {
  out.addList(transfer.vectors), out.addList(transfer.visibility);
  out.add(transfer.rays + transfer.rays_kept);
  out.add(transfer.iterations), out.add(transfer.residual), out.add(transfer.row_bytes);
}

bool read(ByteReader& in, VolumeTransfer& transfer) {
  const std::size_t samples = transfer.grid.samples(),
                    visibility = transfer.bands > 3 ? samples * transfer.visibilitySize() : 0;
  return in.readList(transfer.vectors) && transfer.vectors.size() == samples * transfer.vectorSize() &&
         in.readList(transfer.visibility) && transfer.visibility.size() == visibility &&
         in.read(transfer.rays_kept) && in.read(transfer.iterations) && in.read(transfer.residual) &&
         in.read(transfer.row_bytes);
}

std::optional<VolumeTransfer> bakeVolumeTransfer(const Medium& medium, const VolumeSettings& settings,
                                                 const Occluders& occluders, const BakeContext& context) {
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
  const auto found = findOrMake(context.part("transfer"), out,
                                [&] { return bakeTransfer(medium, settings, occluders, out, context); });
  if (!found) return std::nullopt;
  if (!*found) dropParts(context, out);
  return out;
}

}  // namespace lambent::baker
