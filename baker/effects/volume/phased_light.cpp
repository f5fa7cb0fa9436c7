#include "baker/effects/volume/phased_light.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "baker/jobs/parallel.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kGrain = 16;
constexpr double kY0 = 0.28209479177387814;

// int f y_i ds of a function f of which the mean is `mean` and the sums of (1 - f) y_i over the table `lost`:
// off the closed form of f = 1, so that thin air is exact; the sums of y_i over the table, nearly 0, are put
// right for thick air.
void project(const SphereTable& table, double mean, std::span<const double> lost, std::span<float> out) {
  const double share = 1.0 / static_cast<double>(table.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<float>(4.0 * std::numbers::pi *
                                (i == 0 ? kY0 * mean : (1.0 - mean) * table.mean(i) - lost[i] * share));
}

void findLight(const DensityField& density, const TransferGrid& grid, const Occluders& occluders,
               const SphereTable& table, std::size_t begin, std::size_t end, PhasedLight& light) {
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

}  // namespace

bool findPhasedLight(const DensityField& density, const TransferGrid& grid, const Occluders& occluders,
                     const SphereTable& table, int bands, PhasedLight& light, Progress& progress,
                     const std::stop_token& stop, const Keep& keep) {
  const std::size_t size = table.harmonics(0).size();
  const auto outputs = static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
  light.visibility_size = size;
  light.visibility.resize(grid.samples() * size);
  light.clear.resize(grid.samples() * outputs);
  std::atomic<std::size_t> traced = 0;
  const auto visibilityOf = [&](std::size_t begin, std::size_t end) {
    return std::span(light.visibility).subspan(begin * size, (end - begin) * size);
  };
  const auto clearOf = [&](std::size_t begin, std::size_t end) {
    return std::span(light.clear).subspan(begin * outputs, (end - begin) * outputs);
  };
  const CachedRanges kept =
      cachedRanges(keep, grid.samples(), kGrain, stop,
                   {.compute =
                        [&](std::size_t begin, std::size_t end) {
                          findLight(density, grid, occluders, table, begin, end, light);
                          traced += end - begin;
                          progress.add(end - begin);
                        },
                    .pack =
                        [&](std::size_t begin, std::size_t end, ByteWriter& out) {
                          out.addList(std::span<const float>(visibilityOf(begin, end)));
                          out.addList(std::span<const float>(clearOf(begin, end)));
                        },
                    .unpack =
                        [&](std::size_t begin, std::size_t end, ByteReader& in) {
                          if (!in.readInto(visibilityOf(begin, end)) || !in.readInto(clearOf(begin, end)))
                            return false;
                          progress.add(end - begin);
                          return true;
                        }},
                   KeepWhen::Due);
  light.samples_traced = traced;
  return kept.finished;
}

void dropPhasedLight(const Keep& keep, std::size_t samples) {
  dropRanges(keep, samples, kGrain);
}

}  // namespace lambent::baker
