#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/sh/sphere.hpp"

namespace lambent::sh {
namespace {

using testing::Random;

ZonalFactors makeFactors(int order, bool isotropic) {
  return isotropic ? ZonalFactors::isotropic(order) : ZonalFactors::anisotropic(order);
}

// Returns the largest singular value of a row-major square matrix, by power iteration.
double norm(const std::vector<double>& a, std::size_t n) {
  std::vector<double> v(n, 1.0), w(n);
  for (std::size_t k = 0; k < n; ++k) v[k] += 0.1 * static_cast<double>(k);
  double largest = 0;
  for (int step = 0; step < 2000; ++step) {
    for (std::size_t i = 0; i < n; ++i) {
      w[i] = 0;
      for (std::size_t k = 0; k < n; ++k) w[i] += a[i * n + k] * v[k];
    }
    double length = 0;
    for (std::size_t k = 0; k < n; ++k) {
      v[k] = 0;
      for (std::size_t i = 0; i < n; ++i) v[k] += a[i * n + k] * w[i];
      length += v[k] * v[k];
    }
    length = std::sqrt(length);
    largest = std::sqrt(length);
    for (double& x : v) x /= length;
  }
  return largest;
}

// Returns all coefficients of a function from those that its table stores.
std::vector<float> filled(const std::vector<float>& stored, int order, bool isotropic) {
  if (!isotropic) return stored;
  std::vector<float> all(static_cast<std::size_t>(order * order));
  for (int l = 0; l < order; ++l)
    for (int m = 0; m <= l; ++m)
      all[static_cast<std::size_t>(coefficientIndex(l, m))] =
          stored[static_cast<std::size_t>(l * (l + 1) / 2 + m)];
  return all;
}

// Rounding, and errors of interpolated weights, grow by no more than a small factor.
TEST(ZonalFactors, AreWellConditionedInEveryBand) {
  for (bool isotropic : {true, false}) {
    const ZonalFactors factors = makeFactors(kMaxFactoredOrder, isotropic);
    std::size_t first = 0;
    for (int l = 0; l < kMaxFactoredOrder; ++l) {
      const auto n = static_cast<std::size_t>(factors.axesOfBand(l));
      std::vector<double> forward(n * n), inverse(n * n);
      for (std::size_t k = 0; k < n; ++k) {
        std::vector<double> y(coefficientCount(kMaxFactoredOrder));
        evaluate(kMaxFactoredOrder, glm::dvec3(factors.axes()[k]), y);
        std::vector<float> unit(static_cast<std::size_t>(factors.weightCount())), weights(unit.size());
        unit[first + k] = 1.0f;
        factors.factor(unit, weights);
        for (std::size_t m = 0; m < n; ++m) {
          forward[m * n + k] = y[static_cast<std::size_t>(coefficientIndex(l, isotropic ? 0 : -l)) + m];
          inverse[m * n + k] = static_cast<double>(weights[first + m]);
        }
      }
      const double condition = norm(forward, n) * norm(inverse, n);
      RecordProperty((isotropic ? "plane" : "sphere") + std::to_string(l), std::to_string(condition));
      // The last bands use axes that were chosen for the others.
      const double most = l < 6    ? (isotropic ? 2.1 : 3.6)
                          : l == 6 ? (isotropic ? 2.7 : 11.7)
                                   : (isotropic ? 3.8 : 8.5);
      EXPECT_LT(condition, most) << "band " << l;
      first += n;
    }
  }
}

// Checks that expand(factor(f)) in rotated axes equals f rotated by sh::Rotation.
TEST(ZonalFactors, TurnFunctionsAsRotationMatricesDo) {
  Random random(21);
  std::vector<glm::dquat> turns = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  for (double angle : {1e-7, 1.5707963267948966, 3.14159})
    for (const glm::dvec3& axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)})
      turns.push_back(glm::angleAxis(angle, axis));
  for (int k = 0; k < 50; ++k) turns.push_back(random.rotation());

  for (int order = 1; order <= kMaxFactoredOrder; ++order)
    for (bool isotropic : {true, false}) {
      const ZonalFactors factors = makeFactors(order, isotropic);
      for (const glm::dquat& turn : turns) {
        std::vector<float> f(static_cast<std::size_t>(factors.weightCount())), weights(f.size());
        double energy = 0;
        for (float& c : f) {
          c = static_cast<float>(2 * random.uniform() - 1);
          energy += static_cast<double>(c * c);
        }
        std::vector<glm::vec3> axes;
        for (const glm::vec3& axis : factors.axes()) axes.push_back(glm::vec3(turn * glm::dvec3(axis)));
        std::vector<float> expanded(static_cast<std::size_t>(order * order)), expected(expanded.size());
        factors.factor(f, weights);
        factors.expand(weights, axes, expanded);
        Rotation(turn, order).apply(filled(f, order, isotropic), expected);
        for (std::size_t i = 0; i < expected.size(); ++i)
          EXPECT_NEAR(expanded[i], expected[i], 1e-5 * std::max(1.0, std::sqrt(energy)))
              << "order " << order << (isotropic ? ", plane: " : ", sphere: ") << i;
      }
    }
}

}  // namespace
}  // namespace lambent::sh
