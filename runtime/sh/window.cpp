#include "runtime/sh/window.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "runtime/sh/zonal.hpp"

namespace lambent::sh {

namespace {

constexpr std::size_t kDirections = 1024;
constexpr double kFirstLambda = 1.0 / 4096, kLastLambda = 1 << 20;
constexpr float kGuard = 1e-5f;  // of the mean irradiance: where the search aims

// Spherical Fibonacci points: deterministic, no poles or seams.
struct Directions {
  std::array<float, kDirections> x, y, z;
};
const Directions& searchDirections() {
  static const Directions directions = [] {
    Directions points;
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    for (std::size_t k = 0; k < kDirections; ++k) {
      const double z = 1 - (2 * static_cast<double>(k) + 1) / kDirections, r = std::sqrt(1 - z * z);
      points.x[k] = static_cast<float>(r * std::cos(golden * static_cast<double>(k)));
      points.y[k] = static_cast<float>(r * std::sin(golden * static_cast<double>(k)));
      points.z[k] = static_cast<float>(z);
    }
    return points;
  }();
  return directions;
}

// One channel of the cosine-convolved light, divided by its mean, and what the search knows of it.
struct Channel {
  int order;
  std::array<float, kMaxCoefficients> c{};
  std::vector<glm::vec3> dirs{};                      // the active directions
  std::array<std::vector<float>, kMaxOrder> bands{};  // irradiance of band l towards each of them

  std::array<float, kMaxOrder> bandsTowards(const glm::vec3& dir) const {
    std::array<float, kMaxCoefficients> y;
    evaluate(order, dir, y);
    std::array<float, kMaxOrder> sums{};
    for (int l = 0; l < order; ++l)
      for (int i = l * l; i < (l + 1) * (l + 1); ++i)
        sums[static_cast<std::size_t>(l)] += c[static_cast<std::size_t>(i)] * y[static_cast<std::size_t>(i)];
    return sums;
  }
  float value(const BandWeights& weights, const glm::vec3& dir) const {
    const auto sums = bandsTowards(dir);
    float sum = 0;
    for (std::size_t l = 0; l < sums.size(); ++l) sum += weights[l] * sums[l];
    return sum;
  }
  void add(const glm::vec3& dir) {
    dirs.push_back(dir);
    const auto sums = bandsTowards(dir);
    for (std::size_t l = 0; l < bands.size(); ++l) bands[l].push_back(sums[l]);
  }
  std::vector<float> values(const BandWeights& weights) const {
    std::vector<float> sum(dirs.size(), 0.0f);
    for (std::size_t l = 0; l < static_cast<std::size_t>(order); ++l) {
      if (l >= 3 && l % 2 == 1) continue;  // A_l = 0
      const float weight = weights[l];
      const float* band = bands[l].data();
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * band[k];
    }
    return sum;
  }
};

Channel makeChannel(const LightVector& irradiance, int channel) {
  Channel result{.order = irradiance.order};
  // The mean of y_00 c_0 is c_0 y_00: dividing by it makes the search independent of the light's scale.
  const float mean = irradiance.c[0][channel] * 0.28209479f;
  const auto count = static_cast<std::size_t>(coefficientCount(result.order));
  for (std::size_t i = 0; i < count; ++i) result.c[i] = irradiance.c[i][channel] / mean;

  const Directions& points = searchDirections();
  std::vector<float> basis(count * kDirections);
  evaluateBatch(result.order, points.x.data(), points.y.data(), points.z.data(), kDirections, basis.data());
  for (std::size_t k = 0; k < kDirections; ++k)
    result.dirs.emplace_back(points.x[k], points.y[k], points.z[k]);
  for (auto& band : result.bands) band.assign(kDirections, 0.0f);
  for (std::size_t i = 0; i < count; ++i) {
    float* band = result.bands[static_cast<std::size_t>(bandOf(static_cast<int>(i)))].data();
    const float* y = basis.data() + i * kDirections;
    for (std::size_t k = 0; k < kDirections; ++k) band[k] += result.c[i] * y[k];
  }
  return result;
}

// Descent over the sphere by a shrinking cross of four steps, until a step is under 1e-3: the value then lies
// within about l² step² / 2 = 2e-5 of the local minimum of the bands up to 6.
glm::vec3 descend(const Channel& channel, const BandWeights& weights, glm::vec3 dir) {
  float best = channel.value(weights, dir);
  for (float step = 0.04f; step > 1e-3f;) {
    const glm::vec3 across =
        glm::normalize(glm::cross(dir, std::abs(dir.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
    const glm::vec3 along = glm::cross(dir, across);
    glm::vec3 next = dir;
    for (const glm::vec3& offset : {across, -across, along, -along}) {
      const glm::vec3 candidate = glm::normalize(dir + step * offset);
      const float value = channel.value(weights, candidate);
      if (value < best) {
        best = value;
        next = candidate;
      }
    }
    if (next == dir) step *= 0.5f;
    dir = next;
  }
  return dir;
}

bool negativeSomewhere(const std::vector<Channel>& channels, double lambda, float bound) {
  return std::any_of(channels.begin(), channels.end(), [&](const Channel& channel) {
    const std::vector<float> values = channel.values(laplacianWeights(channel.order, lambda));
    return *std::min_element(values.begin(), values.end()) < bound;
  });
}

// The least lambda for the active directions.
double leastLambda(const std::vector<Channel>& channels) {
  double high = kFirstLambda;
  while (high < kLastLambda && negativeSomewhere(channels, high, kGuard)) high *= 2;
  double low = high == kFirstLambda ? 0 : high / 2;
  while (high - low > 1e-5 * high) {
    const double middle = 0.5 * (low + high);
    (negativeSomewhere(channels, middle, kGuard) ? low : high) = middle;
  }
  return high;
}

// The lowest active directions, each well apart from the others: minima of bands up to 7 hardly lie closer.
std::vector<glm::vec3> lowestDirections(const Channel& channel, const BandWeights& weights) {
  constexpr std::size_t kStarts = 6;
  constexpr float kApart = 0.955f;  // cos 0.3
  const std::vector<float> values = channel.values(weights);
  std::vector<glm::vec3> starts;
  while (starts.size() < kStarts) {
    std::size_t lowest = values.size();
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (lowest < values.size() && values[k] >= values[lowest]) continue;
      const bool apart = std::none_of(starts.begin(), starts.end(), [&](const glm::vec3& start) {
        return glm::dot(start, channel.dirs[k]) > kApart;
      });
      if (apart) lowest = k;
    }
    if (lowest == values.size()) break;
    starts.push_back(channel.dirs[lowest]);
  }
  return starts;
}

// Adds minima of the whole sphere that lie under the bound to the active directions; false if there are none.
bool addNegativeMinima(std::vector<Channel>& channels, double lambda, float bound) {
  bool added = false;
  for (Channel& channel : channels) {
    const BandWeights weights = laplacianWeights(channel.order, lambda);
    for (const glm::vec3& start : lowestDirections(channel, weights)) {
      const glm::vec3 dir = descend(channel, weights, start);
      if (channel.value(weights, dir) >= bound) continue;
      channel.add(dir);
      added = true;
    }
  }
  return added;
}

// Whether a window can make this channel non-negative: its mean is positive, and not lost in its other
// coefficients.
bool canBeHelped(const LightVector& light, int channel) {
  float largest = 0;
  for (const glm::vec3& value : light.coefficients()) largest = std::max(largest, std::abs(value[channel]));
  return light.c[0][channel] > 1e-6f * largest;
}

}  // namespace

BandWeights hannWeights(int order) {
  BandWeights weights{};
  for (int l = 0; l < order; ++l)
    weights[static_cast<std::size_t>(l)] =
        static_cast<float>(0.5 * (1 + std::cos(std::numbers::pi * l / static_cast<double>(order))));
  return weights;
}

BandWeights laplacianWeights(int order, double lambda) {
  BandWeights weights{};
  for (int l = 0; l < order; ++l)
    weights[static_cast<std::size_t>(l)] =
        static_cast<float>(1 / (1 + lambda * l * l * (l + 1.0) * (l + 1.0)));
  return weights;
}

double deringingLambda(const LightVector& light) {
  for (const glm::vec3& value : light.coefficients())
    if (!std::isfinite(value.r) || !std::isfinite(value.g) || !std::isfinite(value.b)) return 0;
  const LightVector irradiance = cosineConvolved(light);
  std::vector<Channel> channels;
  for (int channel = 0; channel < 3; ++channel)
    if (canBeHelped(light, channel)) channels.push_back(makeChannel(irradiance, channel));
  if (channels.empty()) return 0;

  // Untouched if there is no negative value, up to rounding; half the guard keeps this apart from the
  // search's aim.
  constexpr int kMaxRounds = 8;
  double lambda = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const float bound = lambda == 0 ? -0.5f * kGuard : 0.0f;
    if (!negativeSomewhere(channels, lambda, bound) && !addNegativeMinima(channels, lambda, bound)) break;
    lambda = leastLambda(channels);
  }
  return lambda;
}

BandWeights windowWeights(const LightVector& light, Window window) {
  switch (window) {
    case Window::Off:
      return laplacianWeights(light.order, 0);
    case Window::Hann:
      return hannWeights(light.order);
    case Window::Auto:
      return laplacianWeights(light.order, deringingLambda(light));
  }
  return laplacianWeights(light.order, 0);
}

LightVector applyWindow(const LightVector& light, Window window) {
  return window == Window::Off ? light : applyWeights(light, windowWeights(light, window));
}

LightVector applyWeights(const LightVector& light, const BandWeights& weights) {
  LightVector result{.order = light.order};
  for (std::size_t i = 0; i < light.coefficients().size(); ++i)
    result.c[i] = light.c[i] * weights[static_cast<std::size_t>(bandOf(static_cast<int>(i)))];
  return result;
}

}  // namespace lambent::sh
