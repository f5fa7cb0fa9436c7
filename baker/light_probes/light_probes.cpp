#include "baker/light_probes/light_probes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>

#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

namespace {

constexpr int kMostRoundsOfPoints = 32;
constexpr float kSettled = 1e-4f;  // of the points' size; centres that move less have converged

struct Points {
  std::vector<glm::dvec3> places;
  std::vector<double> weights;
};

// Returns the points that count: those with an area, or all if none has one.
Points pointsOf(std::span<const glm::vec3> points, std::span<const float> areas) {
  const bool bare = std::none_of(areas.begin(), areas.end(), [](float area) { return area > 0.0f; });
  Points out;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (bare || areas[i] > 0.0f) {
      out.places.emplace_back(points[i]);
      out.weights.push_back(bare ? 1.0 : double{areas[i]});
    }
  return out;
}

double squared(glm::dvec3 v) {
  return glm::dot(v, v);
}

// Chooses farthest points first: the one farthest from the mean, then always the one farthest from all before
// it, and the first in the list among equals. Stops if all that are left coincide with a chosen one.
std::vector<glm::dvec3> farthestPoints(const Points& points, glm::dvec3 mean, std::size_t count) {
  std::vector<double> distances(points.places.size());
  std::transform(points.places.begin(), points.places.end(), distances.begin(),
                 [&](glm::dvec3 place) { return squared(place - mean); });
  std::vector<glm::dvec3> seeds;
  for (double smallest = -1.0; seeds.size() < count; smallest = 0.0) {
    const auto farthest = std::max_element(distances.begin(), distances.end());
    if (*farthest <= smallest) break;
    seeds.push_back(points.places[static_cast<std::size_t>(farthest - distances.begin())]);
    for (std::size_t i = 0; i < distances.size(); ++i) {
      const double here = squared(points.places[i] - seeds.back());
      distances[i] = seeds.size() == 1 ? here : std::min(distances[i], here);
    }
  }
  return seeds;
}

// Does one round of Lloyd's algorithm: each centre moves to the mean of the points nearest to it, and a
// centre without points is dropped. Returns the largest squared distance that a centre moved.
double moveToMeans(const Points& points, std::vector<glm::dvec3>& centres) {
  std::vector<glm::dvec3> sums(centres.size(), glm::dvec3(0.0));
  std::vector<double> weights(centres.size(), 0.0);
  for (std::size_t i = 0; i < points.places.size(); ++i) {
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < centres.size(); ++k)
      if (const double distance = squared(points.places[i] - centres[k]); distance < least)
        least = distance, nearest = k;
    sums[nearest] += points.weights[i] * points.places[i];
    weights[nearest] += points.weights[i];
  }
  std::vector<glm::dvec3> moved;
  double farthest = 0.0;
  for (std::size_t k = 0; k < centres.size(); ++k) {
    if (!(weights[k] > 0.0)) continue;
    moved.push_back(sums[k] / weights[k]);
    farthest = std::max(farthest, squared(moved.back() - centres[k]));
  }
  centres = std::move(moved);
  return farthest;
}

}  // namespace

std::vector<glm::vec3> lightPoints(std::span<const glm::vec3> points, std::span<const float> areas,
                                   std::size_t count) {
  const Points used = pointsOf(points, areas);
  if (used.places.empty()) return {};
  glm::dvec3 mean(0.0);
  for (std::size_t i = 0; i < used.places.size(); ++i) mean += used.weights[i] * used.places[i];
  mean /= std::reduce(used.weights.begin(), used.weights.end());
  double size = 0.0;
  for (const glm::dvec3& place : used.places) size = std::max(size, squared(place - mean));

  std::vector<glm::dvec3> centres = farthestPoints(used, mean, std::max<std::size_t>(count, 1));
  for (int round = 0; round < kMostRoundsOfPoints; ++round)
    if (moveToMeans(used, centres) <= double{kSettled} * double{kSettled} * size) break;
  std::vector<glm::vec3> out;
  for (const glm::dvec3& centre : centres) out.emplace_back(centre);
  return out;
}

void mergePoints(std::vector<glm::vec3>& points, float distance) {
  // Sorted along x, only points that are near in x need comparing.
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return points[a].x < points[b].x; });
  std::vector<bool> gone(points.size(), false);
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1;
         !gone[order[i]] && j < order.size() && points[order[j]].x - points[order[i]].x <= distance; ++j)
      if (glm::distance(points[order[i]], points[order[j]]) <= distance) gone[order[j]] = true;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!gone[i]) points[kept++] = points[i];
  points.resize(kept);
}

namespace {

// Measured on knot, teapot, sphere and box under local lights: more rounds give nothing, and a smaller mu
// fits better if light is far and worse if it is near.
constexpr int kRounds = 4;
constexpr double kNearness = 0.3;  // mu
// This many samples, taken evenly through each cell, say how the surface lies.
constexpr std::size_t kLeastUsed = 16384, kUsedPerPoint = 64;
constexpr std::size_t kGrainOfFit = 512;
constexpr int kSweeps = 64, kHalvings = 12;

struct Used {
  std::size_t sample = 0;
  std::size_t cell = 0;
  double area = 0.0;
  BlendWeights blend{};  // over all points
};

std::vector<Used> usedSamples(const SampleSet& samples, std::span<const float> areas, std::size_t points) {
  const std::size_t wanted = std::max(kLeastUsed, kUsedPerPoint * points);
  const std::size_t stride = std::max<std::size_t>(1, samples.size() / wanted);
  const bool bare = std::none_of(areas.begin(), areas.end(), [](float area) { return area > 0.0f; });
  std::vector<Used> used;
  for (std::size_t c = 0; c < samples.cells.size(); ++c)
    for (std::size_t i = 0; i < samples.cells[c].count; i += stride) {
      const std::size_t sample = samples.cells[c].first + i;
      const double area = bare ? 1.0 : double{areas[sample]};
      if (area > 0.0) used.push_back({.sample = sample, .cell = c, .area = area});
    }
  return used;
}

void blend(std::vector<Used>& used, const SampleSet& samples, std::span<const glm::vec3> points,
           double eps_m2) {
  std::vector<std::vector<std::uint32_t>> near;
  std::vector<std::vector<glm::vec3>> places(samples.cells.size());
  for (std::size_t c = 0; c < samples.cells.size(); ++c) {
    near.push_back(lightsNear(samples.cells[c].bounds_min, samples.cells[c].bounds_max, points));
    for (const std::uint32_t k : near.back()) places[c].push_back(points[k]);
  }
  parallelRanges(used.size(), kGrainOfFit, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Used& u = used[i];
      u.blend = blendWeights(samples.positions[u.sample], places[u.cell], eps_m2);
      for (std::uint32_t& light : u.blend.light) light = near[u.cell][light];
    }
  });
}

// A Row is one row of the normal equations, for one point: sum_j matrix_kj x_j = right_k.
struct Row {
  std::map<std::uint32_t, double> matrix;
  glm::dvec3 right{0.0};
};

std::vector<Row> equations(const std::vector<Used>& used, const SampleSet& samples, std::size_t points) {
  std::vector<Row> rows(points);
  for (const Used& u : used) {
    const glm::dvec3 place(samples.positions[u.sample]);
    for (std::size_t i = 0; i < u.blend.weight.size(); ++i) {
      const double weight = u.area * u.blend.weight[i];
      if (!(weight > 0.0)) continue;
      Row& row = rows[u.blend.light[i]];
      for (std::size_t j = 0; j < u.blend.weight.size(); ++j)
        if (u.blend.weight[j] > 0.0) row.matrix[u.blend.light[j]] += weight * u.blend.weight[j];
      row.matrix[u.blend.light[i]] += kNearness * weight;
      row.right += (1.0 + kNearness) * weight * place;
    }
  }
  return rows;
}

// Solves by Gauss-Seidel; the matrix is positive definite. Points that light nothing stay.
std::vector<glm::vec3> solved(const std::vector<Row>& rows, std::span<const glm::vec3> points) {
  std::vector<glm::dvec3> x(points.begin(), points.end());
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t k = 0; k < rows.size(); ++k) {
      glm::dvec3 rest = rows[k].right;
      double own = 0.0;
      for (const auto& [j, value] : rows[k].matrix)
        if (j == k)
          own = value;
        else
          rest -= value * x[j];
      if (own > 0.0) x[k] = rest / own;
    }
  return {x.begin(), x.end()};
}

// Returns how far a place lies outside of the surface, judged by the nearest of some samples.
float outside(glm::vec3 place, std::span<const std::size_t> around, const SampleSet& samples) {
  float least = std::numeric_limits<float>::max(), side = 0.0f;
  for (const std::size_t i : around) {
    const glm::vec3 away = place - samples.positions[i];
    if (const float distance = glm::dot(away, away); distance < least)
      least = distance, side = glm::dot(away, samples.normals[i]);
  }
  return side;
}

}  // namespace

void fitPoints(std::vector<glm::vec3>& points, const SampleSet& samples, std::span<const float> areas,
               double eps_m2, float depth_m) {
  const bool closed = samples.normals.size() == samples.size();
  const std::vector<glm::vec3> means = points;
  std::vector<Used> used = usedSamples(samples, areas, points.size());
  for (int round = 0; round < kRounds; ++round) {
    blend(used, samples, points, eps_m2);
    const std::vector<glm::vec3> wanted = solved(equations(used, samples, points.size()), points);
    std::vector<std::vector<std::size_t>> around(points.size());
    for (const Used& u : used)
      for (std::size_t i = 0; closed && i < u.blend.weight.size(); ++i)
        if (u.blend.weight[i] > 0.0) around[u.blend.light[i]].push_back(u.sample);
    parallelRanges(points.size(), 1, {}, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        if (!std::isfinite(wanted[k].x + wanted[k].y + wanted[k].z)) continue;
        const float limit =
            around[k].empty() ? 0.0f : std::max(-depth_m, outside(means[k], around[k], samples));
        const auto good = [&](glm::vec3 place) {
          return around[k].empty() || outside(place, around[k], samples) <= limit + 1e-3f * depth_m;
        };
        points[k] = wanted[k];
        if (good(points[k])) continue;
        glm::vec3 inside = means[k], beyond = wanted[k];
        for (int i = 0; i < kHalvings; ++i) {
          const glm::vec3 middle = 0.5f * (inside + beyond);
          (good(middle) ? inside : beyond) = middle;
        }
        points[k] = inside;
      }
    });
  }
}

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
