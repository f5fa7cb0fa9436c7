#include "runtime/sh/zonal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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
