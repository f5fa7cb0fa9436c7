#include "baker/light_probes/light_points.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>

#include <glm/geometric.hpp>

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

}  // namespace lambent::baker
