#include "baker/light_probes/fit_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "baker/light_probes/blend_weights.hpp"

namespace lambent::baker {

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
