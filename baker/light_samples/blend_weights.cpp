#include "baker/light_samples/blend_weights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <glm/geometric.hpp>

namespace lambent::baker {

namespace {

constexpr std::size_t kMost = bundle::kLightsPerSample;
constexpr std::uint32_t kSteps = 255;

double squaredDistance(glm::vec3 a, glm::vec3 b) {
  const glm::dvec3 d = glm::dvec3(a) - glm::dvec3(b);
  return glm::dot(d, d);
}

}  // namespace

BlendWeights blendWeights(glm::vec3 place, std::span<const glm::vec3> lights, double eps_m2) {
  // The five nearest, nearest first; the first in the list where several are equally near.
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::array<double, kMost + 1> nearest;
  std::array<std::uint32_t, kMost + 1> which{};
  nearest.fill(kFar);
  for (std::uint32_t k = 0; k < lights.size(); ++k) {
    const double distance = squaredDistance(place, lights[k]);
    if (distance >= nearest.back()) continue;
    std::size_t slot = kMost;
    for (; slot > 0 && nearest[slot - 1] > distance; --slot)
      nearest[slot] = nearest[slot - 1], which[slot] = which[slot - 1];
    nearest[slot] = distance, which[slot] = k;
  }

  BlendWeights out;
  const double reach = std::sqrt(nearest.back());
  double sum = 0.0;
  for (std::size_t k = 0; k < kMost; ++k) {
    if (nearest[k] == kFar) break;
    const double fade = reach == kFar ? 1.0 : reach > 0.0 ? 1.0 - std::sqrt(nearest[k]) / reach : 0.0;
    out.light[k] = which[k];
    out.weight[k] = fade * fade / std::max(nearest[k] + eps_m2, std::numeric_limits<double>::min());
    sum += out.weight[k];
  }
  if (sum > 0.0 && std::isfinite(sum))
    for (double& weight : out.weight) weight /= sum;
  else  // five or more equally near
    out.weight = {1.0, 0.0, 0.0, 0.0};
  return out;
}

QuantizedWeights quantized(const BlendWeights& weights) {
  std::array<double, kMost> rest{};
  std::array<std::uint32_t, kMost> steps{};
  for (std::size_t k = 0; k < kMost; ++k) {
    steps[k] = static_cast<std::uint32_t>(std::floor(weights.weight[k] * kSteps));
    rest[k] = weights.weight[k] * kSteps - steps[k];
  }
  for (std::uint32_t sum = std::accumulate(steps.begin(), steps.end(), 0u); sum < kSteps; ++sum) {
    const auto largest = std::max_element(rest.begin(), rest.end());
    ++steps[static_cast<std::size_t>(largest - rest.begin())];
    *largest = -1.0;
  }
  std::array<std::size_t, kMost> order{};
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return steps[a] > steps[b]; });
  QuantizedWeights out;
  for (std::size_t k = 0; k < kMost; ++k) {
    if (steps[order[k]] == 0) break;
    out.light[k] = weights.light[order[k]];
    out.weight[k] = static_cast<std::uint8_t>(steps[order[k]]);
  }
  return out;
}

std::vector<std::uint32_t> lightsNear(glm::vec3 box_min, glm::vec3 box_max,
                                      std::span<const glm::vec3> lights) {
  const glm::vec3 centre = 0.5f * (box_min + box_max);
  std::vector<double> distances;
  for (const glm::vec3& light : lights) distances.push_back(std::sqrt(squaredDistance(centre, light)));
  std::vector<std::uint32_t> near(lights.size());
  std::iota(near.begin(), near.end(), 0u);
  if (lights.size() <= kMost + 1) return near;
  // From a place in the box the fifth nearest is no farther than this, by way of the centre; what is that
  // near to the place is at most half a diagonal farther from the centre.
  std::vector<double> sorted = distances;
  std::nth_element(sorted.begin(), sorted.begin() + kMost, sorted.end());
  const double reach = 1.0001 * (sorted[kMost] + double{glm::distance(box_min, box_max)});
  std::erase_if(near, [&](std::uint32_t k) { return distances[k] > reach; });
  return near;
}

}  // namespace lambent::baker
