#include "baker/effects/volume/volume_transfer.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "baker/effects/volume/first_light.hpp"
#include "baker/effects/volume/fit_within_voxels.hpp"
#include "baker/effects/volume/gmres.hpp"
#include "baker/effects/volume/keep_solved.hpp"
#include "baker/effects/volume/phased_transfer.hpp"
#include "baker/effects/volume/scatter_rows.hpp"
#include "baker/effects/volume/sphere_table.hpp"
#include "baker/jobs/parallel.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kLeastScatteringRays = 64;
constexpr std::size_t kGrain = 16;
constexpr double kTolerance = 1e-5;

// What arrives unscattered, and what stands in its way.
struct FirstLights {
  std::vector<float> transfer;   // [sample][order²]
  std::vector<double> met, out;  // share of the directions whose light the medium meets, and the rest
};

// rays: of those that were not kept.
bool lightIn(const Medium& medium, const TransferGrid& grid, const Occluders& occluders,
             const SphereTable& table, std::size_t columns, FirstLights& light, std::uint64_t& rays,
             Progress& progress, const std::stop_token& stop, const Keep& keep) {
  light.transfer.resize(grid.samples() * columns);
  light.met.resize(grid.samples());
  light.out.resize(grid.samples());
  std::atomic<std::uint64_t> traced = 0;
  const auto parts = [&](std::size_t begin, std::size_t end, const auto& visit) {
    const std::size_t count = end - begin;
    return visit(std::span(light.transfer).subspan(begin * columns, count * columns)) &&
           visit(std::span(light.met).subspan(begin, count)) &&
           visit(std::span(light.out).subspan(begin, count));
  };
  const CachedRanges kept = cachedRanges(
      keep, grid.samples(), kGrain, stop,
      {.compute =
           [&](std::size_t begin, std::size_t end) {
             FirstLight first(*medium.density, occluders);
             for (std::size_t p = begin; p < end; ++p) {
               const Arrival arrival =
                   first.look(grid.place(p), table, std::span(light.transfer).subspan(p * columns, columns));
               light.met[p] = arrival.met;
               light.out[p] = arrival.out;
             }
             traced += (end - begin) * table.size();
             progress.add(end - begin);
           },
       .pack =
           [&](std::size_t begin, std::size_t end, ByteWriter& out) {
             parts(begin, end, [&]<typename T>(std::span<T> part) {
               out.addList(std::span<const T>(part));
               return true;
             });
           },
       .unpack =
           [&](std::size_t begin, std::size_t end, ByteReader& in) {
             if (!parts(begin, end, [&](auto part) { return in.readInto(part); })) return false;
             progress.add(end - begin);
             return true;
           }},
      KeepWhen::Due);
  rays += traced;
  return kept.finished;
}

// T = T0 + w K T for a block of columns, on the diagonal's scale: what a sample keeps to itself is taken out
// of the iteration, so that thick media converge too. result, first: [sample][kBlockColumns].
class Scattering {
 public:
  Scattering(const ScatterRows& rows, const TransferGrid& grid, const FirstLights& light, double albedo,
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

  GmresResult solve(std::span<const float> first, std::span<float> result, const Keep& keep) {
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
                      {.tolerance = kTolerance, .keep = keep});
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

bool scatter(const ScatterRows& rows, const FirstLights& light, const VolumeSettings& settings,
             VolumeTransfer& out, Progress& progress, const std::stop_token& stop, const Keep& keep) {
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
      const GmresResult done = keepSolved(keep.part("block", block, channel), result, [&](const Keep& at) {
        return settings.scatterings < 0 ? scattering.solve(first, result, at)
                                        : scattering.repeat(first, result, settings.scatterings);
      });
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

// Checkpoints of what is all there now.
void dropParts(const Keep& keep, const VolumeTransfer& transfer) {
  if (!keep.cache) return;
  const std::size_t samples = transfer.grid.samples();
  if (transfer.bands > 1) {
    dropPhasedParts(keep, samples);
  } else {
    dropRanges(keep.part("light"), samples, kGrain);
    ScatterRows::drop(keep.part("rows"), samples);
    dropWithinVoxels(keep.part("within voxels"), *transfer.density, transfer.grid);
  }
  for (std::size_t block = 0; block < transfer.columns(); block += kBlockColumns)
    for (std::uint32_t channel = 0; channel < transfer.full_channels; ++channel)
      dropSolved(keep.part("block", block, channel));
}

bool bakeTransfer(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                  VolumeTransfer& out, Progress& progress, const std::stop_token& stop, const Keep& keep) {
  const std::size_t samples = out.grid.samples(), columns = out.columns();
  out.vectors.resize(samples * out.vectorSize());
  if (samples == 0) return true;
  if (out.bands > 1) return bakePhasedTransfer(medium, settings, occluders, out, progress, stop, keep);

  const SphereTable table(settings.rays, settings.order);
  progress.begin("light into volumes", samples, "samples");
  FirstLights light;
  if (!lightIn(medium, out.grid, occluders, table, columns, light, out.rays, progress, stop,
               keep.part("light")))
    return false;
  out.rays_kept = samples * table.size() - out.rays;
  for (std::size_t p = 0; p < samples; ++p)
    std::copy_n(&light.transfer[p * columns], columns, &out.vectors[p * out.vectorSize()]);
  const auto fit = [&](const ScatterRows* rows) {
    return !settings.fit_within_voxels || fitWithinVoxels(medium, settings, occluders, rows, out, progress,
                                                          stop, keep.part("within voxels"));
  };
  if (out.full_channels == 0) return fit(nullptr);

  const SphereTable few(std::max(kLeastScatteringRays, settings.rays / kRaysPerScatteringRay), 1);
  progress.begin("scattering", samples, "samples");
  const auto rows = ScatterRows::build(*medium.density, out.grid, occluders, few, light.met, settings.memory,
                                       progress, stop, keep.part("rows"));
  if (!rows) return false;
  out.rays += rows->samplesTraced() * few.size();
  out.rays_kept += (samples - rows->samplesTraced()) * few.size();
  out.row_bytes = rows->bytes();
  progress.begin("scattered light", columns * out.full_channels, "columns");
  return scatter(*rows, light, settings, out, progress, stop, keep) && fit(&*rows);
}

}  // namespace

std::optional<VolumeTransfer> bakeVolumeTransfer(const Medium& medium, const VolumeSettings& settings,
                                                 const Occluders& occluders, Progress& progress,
                                                 const std::stop_token& stop, const Keep& keep) {
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
  const std::size_t samples = out.grid.samples(),
                    visibility = out.bands > 3 ? samples * out.visibilitySize() : 0;
  const std::optional<bool> found = cachedValue(
      keep.part("transfer"),
      [&](ByteReader& in) {
        return in.readList(out.vectors) && out.vectors.size() == samples * out.vectorSize() &&
               in.readList(out.visibility) && out.visibility.size() == visibility && in.read(out.rays_kept) &&
               in.read(out.iterations) && in.read(out.residual) && in.read(out.row_bytes);
      },
      [&] {
        out.vectors.clear(), out.visibility.clear(), out.rays_kept = 0;
        return bakeTransfer(medium, settings, occluders, out, progress, stop, keep);
      },
      [&](ByteWriter& to) {
        to.addList(out.vectors), to.addList(out.visibility), to.add(out.rays + out.rays_kept);
        to.add(out.iterations), to.add(out.residual), to.add(out.row_bytes);
      });
  if (!found) return std::nullopt;
  if (!*found) dropParts(keep, out);
  return out;
}

}  // namespace lambent::baker
