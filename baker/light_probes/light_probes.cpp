#include "baker/light_probes/light_probes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "baker/light_probes/blend_weights.hpp"
#include "baker/light_probes/light_points.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

namespace {

// These are relative to the group's diagonal: points nearer than kMerge are one; kFlat decides which light
// probes blend where several would do equally well; kDepth is how deep under the surface they lie at least.
constexpr float kMerge = 1e-6f, kFlat = 1e-3f, kDepth = 5e-3f;
constexpr std::size_t kGrainOfSamples = 4096;

LightProbes atCentre(const SampleSet& samples, glm::vec3 bounds_min, glm::vec3 bounds_max) {
  LightProbes out;
  out.points = {0.5f * bounds_min + 0.5f * bounds_max};
  out.cells.assign(samples.cells.size(), {{0}, {}});
  return out;
}

// Returns how many each cell gets. A count for the group is shared by area (largest remainder), at least one
// per cell.
std::vector<std::size_t> countsOf(const SampleSet& samples, std::span<const float> areas,
                                  LightProbeCount count) {
  std::vector<std::size_t> counts(samples.cells.size(), count.count);
  if (!count.of_group) return counts;
  std::vector<double> shares;
  for (const SampleCell& cell : samples.cells) {
    const auto own = areas.subspan(cell.first, cell.count);
    shares.push_back(std::accumulate(own.begin(), own.end(), 0.0));
  }
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (std::size_t c = 0; c < counts.size(); ++c) {
    const double share = sum > 0.0 ? shares[c] / sum : 1.0 / static_cast<double>(counts.size());
    counts[c] = static_cast<std::size_t>(std::max(1l, std::lround(share * count.count)));
  }
  return counts;
}

struct Weighed {
  std::vector<std::uint32_t> near;        // among all points
  std::vector<QuantizedWeights> weights;  // `light` indexes `near`
  std::vector<std::uint32_t> used;        // into `near`, ascending
};

Weighed weigh(const SampleSet& samples, const SampleCell& cell, std::span<const glm::vec3> points,
              double eps_m2) {
  Weighed out;
  out.near = lightsNear(cell.bounds_min, cell.bounds_max, points);
  std::vector<glm::vec3> places;
  for (const std::uint32_t k : out.near) places.push_back(points[k]);
  out.weights.resize(cell.count);
  parallelRanges(cell.count, kGrainOfSamples, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      out.weights[i] = quantized(blendWeights(samples.positions[cell.first + i], places, eps_m2));
  });
  std::vector<bool> used(out.near.size(), false);
  for (const QuantizedWeights& weights : out.weights)
    for (std::size_t k = 0; k < transfer::kLightsPerSample; ++k)
      if (weights.weight[k] > 0) used[weights.light[k]] = true;
  for (std::uint32_t k = 0; k < used.size(); ++k)
    if (used[k]) out.used.push_back(k);
  return out;
}

// Makes the lists of the cells, keeping only points that some cell uses.
LightProbes gather(std::span<const glm::vec3> points, const std::vector<Weighed>& weighed) {
  std::vector<std::uint32_t> number(points.size(), 0);
  for (const Weighed& cell : weighed)
    for (const std::uint32_t k : cell.used) number[cell.near[k]] = 1;
  LightProbes out;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (number[k] != 0) {
      number[k] = static_cast<std::uint32_t>(out.points.size());
      out.points.push_back(points[k]);
    }
  for (const Weighed& cell : weighed) {
    LightProbes::Cell& listed = out.cells.emplace_back();
    std::vector<std::uint8_t> place(cell.near.size(), 0);
    for (const std::uint32_t k : cell.used) {
      place[k] = static_cast<std::uint8_t>(listed.points.size());
      listed.points.push_back(number[cell.near[k]]);
    }
    if (listed.points.size() == 1) continue;
    for (const QuantizedWeights& weights : cell.weights) {
      transfer::LightWeights& stored = listed.weights.emplace_back();
      stored.weight = weights.weight;
      for (std::size_t k = 0; k < transfer::kLightsPerSample; ++k)
        if (weights.weight[k] > 0) stored.light[k] = place[weights.light[k]];
    }
  }
  return out;
}

}  // namespace

LightProbes chooseLightProbes(const SampleSet& samples, std::span<const float> areas, glm::vec3 bounds_min,
                              glm::vec3 bounds_max, LightProbeCount count) {
  const float diagonal = glm::distance(bounds_min, bounds_max);
  for (; count.count > 1 && diagonal > 0.0f && std::isfinite(diagonal); --count.count) {
    const auto counts = countsOf(samples, areas, count);
    std::vector<glm::vec3> points;
    for (std::size_t c = 0; c < samples.cells.size(); ++c) {
      const SampleCell& cell = samples.cells[c];
      const auto found = lightPoints(std::span(samples.positions).subspan(cell.first, cell.count),
                                     areas.subspan(cell.first, cell.count), counts[c]);
      points.insert(points.end(), found.begin(), found.end());
    }
    mergePoints(points, kMerge * diagonal);
    if (points.size() < 2) break;
    const double flat = double{kFlat} * double{diagonal};
    fitPoints(points, samples, areas, flat * flat, kDepth * diagonal);
    mergePoints(points, kMerge * diagonal);
    std::vector<Weighed> weighed;
    for (const SampleCell& cell : samples.cells) weighed.push_back(weigh(samples, cell, points, flat * flat));
    const auto too_many = [](const Weighed& cell) { return cell.used.size() > bundle::kMaxLightProbes; };
    if (std::none_of(weighed.begin(), weighed.end(), too_many)) return gather(points, weighed);
  }
  return atCentre(samples, bounds_min, bounds_max);
}

}  // namespace lambent::baker
