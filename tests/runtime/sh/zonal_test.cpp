#include "runtime/sh/zonal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/basis.hpp"
#include "tests/runtime/sh/sphere.hpp"

namespace lambent::sh {
namespace {

using testing::Random;

using testing::kDegree;

TEST(ShZonal, HasTheClampedCosinesBands) {
  const std::array<double, 13> expected = {1, 2.0 / 3,    0.25, 0,          -1.0 / 24, 0,          1.0 / 64,
                                           0, -1.0 / 128, 0,    7.0 / 1536, 0,         -3.0 / 1024};
  for (int l = 0; l < 13; ++l)
    EXPECT_NEAR(clampedCosine(l) / kPi, expected[static_cast<std::size_t>(l)], 1e-15) << l;
}

// Compares with quadrature of max(n.s, 0)/pi over the hemisphere about z.
TEST(ShZonal, TransfersAllLightToAnOpenPoint) {
  std::array<double, kMaxCoefficients> expected{}, y, transfer;
  testing::overSphere(40, 0, kPi / 2, 0, 2 * kPi, [&](const glm::dvec3& dir, double weight) {
    evaluate(kMaxOrder, dir, y);
    for (std::size_t i = 0; i < y.size(); ++i) expected[i] += weight * dir.z / kPi * y[i];
  });
  unoccludedTransfer(kMaxOrder, glm::dvec3(0, 0, 1), transfer);
  for (std::size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(transfer[i], expected[i], 1e-12) << i;

  // Uniform light gives exactly 1 (the albedo is left out), for any normal.
  Random random(11);
  std::array<float, kMaxCoefficients> transfer_float;
  for (int k = 0; k < 20; ++k) {
    unoccludedTransfer(5, glm::vec3(random.direction()), transfer_float);
    EXPECT_NEAR(transfer_float[0] * constantLight(5, glm::vec3(1)).c[0].r, 1.0f, 1e-6f);
  }
}

// A wall blocks x < 0 and the receiver looks along z. The table's values carry the Condon-Shortley sign.
TEST(ShZonal, MatchesTheHalfPlaneInClosedForm) {
  std::array<double, 25> transfer{}, y;
  testing::overSphere(40, 0, kPi / 2, -kPi / 2, kPi / 2, [&](const glm::dvec3& dir, double weight) {
    evaluate(5, dir, y);
    for (std::size_t i = 0; i < y.size(); ++i) transfer[i] += weight * dir.z * y[i];
  });
  struct Entry {
    int l, m;
    double value;
  };
  const std::array<Entry, 10> table = {{{0, 0, .443113463},
                                        {1, 0, .511663354},
                                        {1, 1, -.325735651},
                                        {2, 0, .247707956},
                                        {2, 1, -.429044203},
                                        {3, 1, -.304699606},
                                        {3, 3, .078672479},
                                        {4, 0, -.055389183},
                                        {4, 1, -.131370506},
                                        {4, 3, .115854788}}};
  for (int l = 0; l < 5; ++l)
    for (int m = -l; m <= l; ++m) {
      const auto found = std::find_if(table.begin(), table.end(),
                                      [&](const Entry& entry) { return entry.l == l && entry.m == m; });
      const double expected = found == table.end() ? 0 : found->value * (m % 2 == 0 ? 1 : -1);
      // The table's own quadrature reaches 4e-6 where m is odd (a square root at the zenith).
      EXPECT_NEAR(transfer[static_cast<std::size_t>(coefficientIndex(l, m))], expected,
                  m % 2 == 0 ? 1e-9 : 4e-6)
          << l << ", " << m;
    }
  EXPECT_NEAR(transfer[static_cast<std::size_t>(coefficientIndex(1, 1))], std::sqrt(3 / (4 * kPi)) * 2 / 3,
              1e-12);
}

TEST(ShZonal, HasTheDiscsClosedForm) {
  struct Row {
    double degrees;
    std::array<double, 6> bands;
  };
  const std::array<Row, 4> table = {{{5, {.006745, .011660, .014996, .017642, .019851, .021737}},
                                     {20, {.106892, .179560, .217831, .234176, .232424, .215409}},
                                     {40, {.414675, .634221, .627219, .468438, .233047, .002440}},
                                     {90, {1.772454, 1.534990, 0, -.586184, 0, .367410}}}};
  for (const Row& row : table)
    for (int l = 0; l < 6; ++l)
      EXPECT_NEAR(discZonal(l, row.degrees * kDegree), row.bands[static_cast<std::size_t>(l)], 6e-7)
          << row.degrees << " degrees, band " << l;
}

// Covers both branches of discZonal, and discs so small that the closed form cancels.
TEST(ShZonal, KeepsTinyDiscsAccurate) {
  for (int l = 0; l < kMaxOrder; ++l) {
    for (double radius : {1e-9, 1e-6, 0.0046, 0.05}) {
      const double half = std::sin(radius / 2), solid_angle = 4 * kPi * half * half;
      const double delta = solid_angle * std::sqrt((2 * l + 1) / (4 * kPi));
      // Relative to a point light the disc loses l(l+1) a²/8 to first order.
      EXPECT_NEAR(discZonal(l, radius) / delta, 1 - l * (l + 1) * radius * radius / 8,
                  2 * std::pow(l * radius, 4) + 1e-12);
    }
    EXPECT_NEAR(discZonal(l, 0.1 - 1e-12), discZonal(l, 0.1 + 1e-12), 1e-11) << "where the branches meet";
    EXPECT_NEAR(discZonal(l, kPi), l == 0 ? std::sqrt(4 * kPi) : 0, 1e-14) << "the whole sphere";
    EXPECT_EQ(discZonal(l, 0), 0);
  }
}

TEST(ShZonal, TransferAndConvolutionAgree) {
  Random random(12);
  const LightVector light =
      discLight(6, {0.6f, 0, 0.8f}, 0.7, {3, 2, 1}) + constantLight(6, {0.1f, 0.2f, 0.3f});
  for (int k = 0; k < 20; ++k) {
    const glm::vec3 normal(random.direction());
    std::array<float, 36> transfer;
    unoccludedTransfer(6, normal, transfer);
    glm::vec3 sum(0);
    for (std::size_t i = 0; i < transfer.size(); ++i) sum += transfer[i] * light.c[i];
    const glm::vec3 by_cosine = cosineConvolved(light).evaluate(normal);
    for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(sum[channel], by_cosine[channel], 2e-6f);
  }
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

// Rounding, and errors of interpolated weights, grow by no more than a small factor.
TEST(ZonalFactors, AreWellConditionedInEveryBand) {
  for (bool isotropic : {true, false}) {
    const ZonalFactors factors(kMaxFactoredOrder, isotropic);
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

// Checks that f(s) = Σ_l Σ_i w_l,i (2l+1)/4pi P_l(a_i . s), which depends on angles to the axes alone, so
// that turned axes give the turned function.
TEST(ZonalFactors, SumUpToTheFunction) {
  Random random(21);
  for (int order = 1; order <= kMaxFactoredOrder; ++order)
    for (bool isotropic : {true, false})
      for (int k = 0; k < 50; ++k) {
        const ZonalFactors factors(order, isotropic);
        std::vector<float> f(static_cast<std::size_t>(factors.weightCount())), weights(f.size());
        for (float& c : f) c = static_cast<float>(2 * random.uniform() - 1);
        factors.factor(f, weights);
        const glm::dvec3 dir = random.direction();
        std::vector<double> y(static_cast<std::size_t>(coefficientCount(order)));
        evaluate(order, dir, y);
        double sum = 0, expected = 0, energy = 1;
        std::size_t at = 0;
        for (int l = 0; l < order; ++l)
          for (int i = 0; i < factors.axesOfBand(l); ++i, ++at) {
            const double cosine = glm::dot(glm::dvec3(factors.axes()[static_cast<std::size_t>(i)]), dir);
            sum += static_cast<double>(weights[at]) * (2 * l + 1) / (4 * kPi) * legendre(l, cosine);
            const int m = isotropic ? i : i - l;
            const double c = static_cast<double>(f[at]);
            expected += c * y[static_cast<std::size_t>(coefficientIndex(l, m))];
            energy += c * c;
          }
        EXPECT_NEAR(sum, expected, 2e-5 * std::sqrt(energy)) << "order " << order << ", " << isotropic;
      }
}

}  // namespace
}  // namespace lambent::sh
