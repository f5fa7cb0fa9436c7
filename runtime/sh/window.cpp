#include "runtime/sh/window.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "runtime/sh/zonal.hpp"

namespace lambent::sh {

namespace {

constexpr int kDirections = 1024;
constexpr float kGuard = 1e-5f;  // of the mean radiance: what the search aims above 0, for rounding
constexpr float kHopeless =
    1e-6f;  // mean over largest coefficient: below it a channel has no mean to speak of

// --- the positive kernel
// -----------------------------------------------------------------------------------------

// p(t): Legendre of degree k for odd orders, Jacobi (0, 1) of degree k, (P_k + P_k+1) / (1 + t), for even
// ones.
struct Extremal {
  int degree;
  bool even_order;

  double operator()(double t) const {
    if (!even_order) return legendre(degree, t);
    if (t + 1 < 1e-9) t = -1 + 1e-9;  // the quotient is a polynomial: its limit is near enough
    return (legendre(degree, t) + legendre(degree + 1, t)) / (1 + t);
  }

  // Scanned from 1 downwards; zeros of degrees up to 4 lie much further apart than the steps.
  double largestZero() const {
    double high = 1, low = 1;
    while ((*this)(low) > 0) high = low, low -= 1.0 / 64;
    for (int k = 0; k < 60; ++k) ((*this)(0.5 * (low + high)) > 0 ? high : low) = 0.5 * (low + high);
    return 0.5 * (low + high);
  }
};

// --- the least blend
// ---------------------------------------------------------------------------------------------

// One channel of the light, relative to its mean, as it is and under the positive kernel.
struct Channel {
  int order;
  std::array<float, kMaxCoefficients> plain{}, smooth{};

  // The blend that lifts the light to the guard towards `dir`: (1 - a) plain + a smooth = guard. 0 where it
  // need not be lifted, 1 where even the kernel does not suffice.
  float blendTowards(const glm::vec3& dir) const {
    std::array<float, kMaxCoefficients> y;
    evaluate(order, dir, y);
    float as_is = 0, lifted = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(coefficientCount(order)); ++i) {
      as_is += plain[i] * y[i];
      lifted += smooth[i] * y[i];
    }
    if (as_is >= -0.5f * kGuard)
      return 0;  // untouched up to rounding; half the guard keeps this apart from the aim
    if (lifted <= kGuard) return 1;
    return (kGuard - as_is) / (lifted - as_is);
  }
};

// Ascent over the sphere by a shrinking cross of four steps, until a step is under 1e-3 rad.
float climb(const Channel& channel, glm::vec3 dir, float best) {
  for (float step = 0.04f; step > 1e-3f;) {
    const glm::vec3 across =
        glm::normalize(glm::cross(dir, std::abs(dir.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
    const glm::vec3 along = glm::cross(dir, across);
    glm::vec3 next = dir;
    for (const glm::vec3& offset : {across, -across, along, -along}) {
      const glm::vec3 candidate = glm::normalize(dir + step * offset);
      const float blend = channel.blendTowards(candidate);
      if (blend > best) {
        best = blend;
        next = candidate;
      }
    }
    if (next == dir) step *= 0.5f;
    dir = next;
  }
  return best;
}

// Spherical Fibonacci points: no poles or seams, 0.11 rad apart, where bands up to 7 have no room to hide a
// minimum.
glm::vec3 searchDirection(int k) {
  const double z = 1 - (2.0 * k + 1) / kDirections, r = std::sqrt(1 - z * z);
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0)) * k;
  return {static_cast<float>(r * std::cos(turn)), static_cast<float>(r * std::sin(turn)),
          static_cast<float>(z)};
}

float leastBlend(const Channel& channel) {
  constexpr int kClimbs = 8;
  std::vector<std::pair<float, int>> candidates;
  for (int k = 0; k < kDirections; ++k)
    if (const float blend = channel.blendTowards(searchDirection(k)); blend > 0)
      candidates.emplace_back(blend, k);
  const std::size_t climbs = std::min<std::size_t>(kClimbs, candidates.size());
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(climbs),
                    candidates.end(), std::greater<>());
  float best = 0;
  for (std::size_t i = 0; i < climbs; ++i)
    best = std::max(best, climb(channel, searchDirection(candidates[i].second), candidates[i].first));
  return best;
}

}  // namespace

BandWeights hannWeights(int order) {
  BandWeights weights{};
  for (int l = 0; l < order; ++l)
    weights[static_cast<std::size_t>(l)] =
        static_cast<float>(0.5 * (1 + std::cos(std::numbers::pi * l / static_cast<double>(order))));
  return weights;
}

BandWeights positiveWeights(int order) {
  BandWeights weights{};
  weights[0] = 1;
  if (order == 1) return weights;
  const bool even_order = order % 2 == 0;
  const Extremal p{(even_order ? order : order + 1) / 2, even_order};
  const double x = p.largestZero();
  // Simpson over 512 intervals: polynomials of degree 14 at most, exact to 1e-12.
  constexpr int kIntervals = 512;
  std::array<double, kMaxOrder> sums{};
  for (int k = 0; k <= kIntervals; ++k) {
    const double t = -1 + 2.0 * k / kIntervals;
    const double root = std::abs(t - x) < 1e-6 ? (p(x + 1e-4) - p(x - 1e-4)) / 2e-4 : p(t) / (t - x);
    const double kernel = root * root * (even_order ? 1 + t : 1);
    const double weight = k == 0 || k == kIntervals ? 1 : k % 2 == 1 ? 4 : 2;
    for (int l = 0; l < order; ++l) sums[static_cast<std::size_t>(l)] += weight * kernel * legendre(l, t);
  }
  for (std::size_t l = 1; l < static_cast<std::size_t>(order); ++l)
    weights[l] = static_cast<float>(sums[l] / sums[0]);
  return weights;
}

namespace {

double blendFor(const LightVector& light, const BandWeights& kernel) {
  float blend = 0;
  for (int k = 0; k < 3; ++k) {
    Channel channel{.order = light.order};
    const float mean = light.c[0][k] * 0.28209479f;  // of the radiance: c_0 y_00
    float largest = 0;
    for (std::size_t i = 0; i < light.coefficients().size(); ++i) {
      if (!std::isfinite(light.c[i][k])) return 0;
      largest = std::max(largest, std::abs(light.c[i][k]));
      channel.plain[i] = light.c[i][k] / mean;
      channel.smooth[i] = kernel[static_cast<std::size_t>(bandOf(static_cast<int>(i)))] * channel.plain[i];
    }
    if (light.c[0][k] > kHopeless * largest) blend = std::max(blend, leastBlend(channel));
  }
  return double{blend};
}

}  // namespace

double deringingBlend(const LightVector& light) {
  return blendFor(light, positiveWeights(light.order));
}

BandWeights windowWeights(const LightVector& light, Window window) {
  if (window == Window::Hann) return hannWeights(light.order);
  const BandWeights kernel = positiveWeights(light.order);
  const auto blend = static_cast<float>(window == Window::Auto ? blendFor(light, kernel) : 0.0);
  BandWeights weights{};
  for (std::size_t l = 0; l < static_cast<std::size_t>(light.order); ++l)
    weights[l] = 1 - blend + blend * kernel[l];
  return weights;
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
