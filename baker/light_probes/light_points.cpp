#include "baker/light_probes/light_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>

#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "baker/light_probes/blend_weights.hpp"

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

}  // namespace lambent::baker
