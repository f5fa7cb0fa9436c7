#include "baker/effects/volume/phased_light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "baker/jobs/stage.hpp"

namespace lambent::baker {

namespace {

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

}  // namespace

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

void dropPhasedLight(const BakeContext& context, std::size_t samples) {
  dropStage(context, samples, kLightPerRange);
}

}  // namespace lambent::baker
