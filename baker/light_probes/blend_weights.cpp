#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>

#include <glm/geometric.hpp>

#include "baker/light_probes/light_probes.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kMost = transfer::kLightsPerSample;
constexpr std::uint32_t kSteps = 255;

// This is lambda of blendWeights: how much nearness counts beside the point that the weights add up to.
constexpr double kNearnessOfBlend = 0.1;
// This is relative to squared lengths, and makes the choice of weights unique if light probes lie in a plane.
constexpr double kRidge = 1e-10;
constexpr int kMostRoundsOfWeights = 256;

// Solves the first n rows and columns, with the right-hand side in column n; returns false if they are
// singular.
constexpr std::size_t kRows = kMost + 2;  // one light more than are kept, and the multiplier
using Rows = std::array<std::array<double, kRows + 1>, kRows>;
bool solve(Rows& rows, std::size_t n) {
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < n; ++r)
      if (std::abs(rows[r][c]) > std::abs(rows[pivot][c])) pivot = r;
    if (!(std::abs(rows[pivot][c]) > 0.0)) return false;
    std::swap(rows[c], rows[pivot]);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == c) continue;
      const double factor = rows[r][c] / rows[c][c];
      for (std::size_t k = c; k <= n; ++k) rows[r][k] -= factor * rows[c][k];
    }
  }
  for (std::size_t r = 0; r < n; ++r) rows[r][n] /= rows[r][r];
  return true;
}

struct Candidate {
  glm::dvec3 way{0.0};  // from the place to the light
  double cost = 0.0;    // lambda (way² + offset)
};

// Returns a number in [0, 1) that depends on the place alone, so that all cells get the same.
double drawn(glm::vec3 place) {
  std::uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) {
    hash ^= std::bit_cast<std::uint32_t>(place[axis] + 0.0f);
    hash = (hash + 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u;
    hash ^= hash >> 29;
  }
  return static_cast<double>(hash >> 11) * 0x1p-53;
}

// Minimizes |sum w way|² + sum w cost over w >= 0, sum w = 1, by active sets (Nocedal and Wright, Numerical
// Optimization, section 16.5): it solves for the lights in use, drops those that reach 0 on the way there,
// and adds the one with the steepest gradient.
class Blend {
 public:
  explicit Blend(std::span<const Candidate> all, double ridge) : all_(all), ridge_(ridge) {
    used_.push_back(0);
    for (std::size_t k = 1; k < all.size(); ++k)
      if (all[k].cost < all[used_[0]].cost) used_[0] = k;
    weights_.push_back(1.0);
  }

  void minimize() {
    for (int round = 0; round < kMostRoundsOfWeights; ++round) {
      const std::size_t asked = mostAskedFor();
      if (asked == all_.size() || used_.size() > kMost) return;
      used_.push_back(asked);
      weights_.push_back(0.0);
      while (used_.size() > 1 && !step()) {
      }
    }
  }

  std::span<const std::size_t> used() const { return used_; }
  std::span<const double> weights() const { return weights_; }

 private:
  // Returns a light whose slope is lower than that of the lights in use, or the number of lights if there is
  // none.
  std::size_t mostAskedFor() const {
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < used_.size(); ++i) sum += weights_[i] * all_[used_[i]].way;
    const auto slope = [&](std::size_t k) { return 2.0 * glm::dot(all_[k].way, sum) + all_[k].cost; };
    double level = 0.0;
    for (std::size_t i = 0; i < used_.size(); ++i) level += weights_[i] * slope(used_[i]);
    std::size_t asked = all_.size();
    double least = level - 1e-9 * (std::abs(level) + ridge_ / kRidge);
    for (std::size_t k = 0; k < all_.size(); ++k)
      if (const double here = slope(k); here < least && std::ranges::find(used_, k) == used_.end())
        least = here, asked = k;
    return asked;
  }

  // Moves to the best weights of the lights in use; returns false if one of them was dropped on the way.
  bool step() {
    const std::size_t n = used_.size();
    Rows rows{};
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) rows[i][j] = 2.0 * glm::dot(all_[used_[i]].way, all_[used_[j]].way);
      rows[i][i] += ridge_;
      rows[i][n] = rows[n][i] = 1.0;
      rows[i][n + 1] = -all_[used_[i]].cost;
    }
    rows[n][n + 1] = 1.0;
    double share = 1.0;
    std::size_t goes = n;
    if (!solve(rows, n + 1)) {
      goes = n - 1;  // the new light is a combination of the others
      share = 0.0;
    }
    for (std::size_t i = 0; i < n && share > 0.0; ++i)
      if (const double wanted = rows[i][n + 1]; !(wanted > 0.0))
        if (const double until = weights_[i] / (weights_[i] - wanted); !(until >= share))
          share = until, goes = i;
    for (std::size_t i = 0; i < n && share > 0.0; ++i) weights_[i] += share * (rows[i][n + 1] - weights_[i]);
    if (goes == n) return true;
    used_.erase(used_.begin() + static_cast<std::ptrdiff_t>(goes));
    weights_.erase(weights_.begin() + static_cast<std::ptrdiff_t>(goes));
    return false;
  }

  std::span<const Candidate> all_;
  double ridge_;
  std::vector<std::size_t> used_;
  std::vector<double> weights_;
};

double squaredDistance(glm::vec3 a, glm::vec3 b) {
  const glm::dvec3 d = glm::dvec3(a) - glm::dvec3(b);
  return glm::dot(d, d);
}

}  // namespace

BlendWeights blendWeights(glm::vec3 place, std::span<const glm::vec3> lights, double eps_m2) {
  BlendWeights out;
  out.weight[0] = 1.0;
  if (lights.empty()) return out;
  std::vector<Candidate> all;
  double squares = 0.0;
  for (const glm::vec3& light : lights) {
    const glm::dvec3 way = glm::dvec3(light) - glm::dvec3(place);
    all.push_back({way, kNearnessOfBlend * (glm::dot(way, way) + eps_m2 * drawn(light))});
    squares += glm::dot(way, way);
  }
  Blend blend(all, kRidge * squares / static_cast<double>(all.size()));
  blend.minimize();

  std::vector<std::size_t> order(blend.used().size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return blend.weights()[i]; });
  order.resize(std::min(order.size(), kMost));
  double sum = 0.0;
  for (const std::size_t i : order) sum += blend.weights()[i];
  for (std::size_t k = 0; k < order.size(); ++k) {
    out.light[k] = static_cast<std::uint32_t>(blend.used()[order[k]]);
    out.weight[k] = blend.weights()[order[k]] / sum;
  }
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
  if (lights.empty()) return near;
  // With d the distance of the nearest light, s the weighted sum of the ways and m the mean of their squares,
  // s² + lambda m <= (1 + lambda) d² (the value for the nearest alone). Lights in use all have the slope 2
  // e·s + lambda e² = 2 s² + lambda m <= s² + (1 + lambda) d², so lambda e² - 2 e s is at most that, and e is
  // longest where s is, at s² = (1 + lambda) d².
  const double l = kNearnessOfBlend, root = std::sqrt(1.0 + l);
  const double reach = (root + std::sqrt((1.0 + l) * (1.0 + 2.0 * l))) / l;
  const double half = 0.5 * double{glm::distance(box_min, box_max)};
  const double farthest = reach * (*std::ranges::min_element(distances) + half) + half;
  std::erase_if(near, [&](std::uint32_t k) { return distances[k] > 1.001 * farthest; });
  return near;
}

}  // namespace lambent::baker
