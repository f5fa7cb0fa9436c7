#include "runtime/sh/basis.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"
#include "tests/runtime/sh/sphere.hpp"

namespace lambent::sh {
namespace {

using testing::Random;

std::vector<double> evaluated(int order, const glm::dvec3& dir) {
  std::vector<double> y(static_cast<std::size_t>(coefficientCount(order)));
  evaluate(order, dir, y);
  return y;
}

TEST(ShBasis, HasTheConstantsOfTheConventions) {
  const double x = 0.6, y = -0.48, z = 0.64;
  const auto values = evaluated(3, {x, y, z});
  const std::array<double, 9> expected = {0.282094791773878,
                                          0.488602511902920 * y,
                                          0.488602511902920 * z,
                                          0.488602511902920 * x,
                                          1.092548430592079 * x * y,
                                          1.092548430592079 * y * z,
                                          0.315391565252520 * (3 * z * z - 1),
                                          1.092548430592079 * x * z,
                                          0.546274215296040 * (x * x - y * y)};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(values[i], expected[i], 1e-14) << i;
}

// 64 Gauss nodes in polar angle and azimuth integrate products of two functions of band 10 to rounding.
TEST(ShBasis, IsOrthonormalAtEveryOrder) {
  for (int order = 1; order <= kMaxBasisOrder; ++order) {
    const auto count = static_cast<std::size_t>(coefficientCount(order));
    std::vector<double> gram(count * count);
    testing::overSphere(64, [&](const glm::dvec3& dir, double weight) {
      const auto y = evaluated(order, dir);
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < count; ++j) gram[i * count + j] += weight * y[i] * y[j];
    });
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j)
        EXPECT_NEAR(gram[i * count + j], i == j ? 1.0 : 0.0, 1e-12)
            << "order " << order << ": " << i << ", " << j;
  }
}

// sum_m y_lm² is (2l+1)/4pi in every direction, also at and near the poles.
TEST(ShBasis, KeepsTheEnergyOfEachBandEverywhere) {
  std::vector<glm::dvec3> dirs = {{0, 0, 1},       {0, 0, -1}, {1e-20, 0, 1},
                                  {0, -1e-20, -1}, {1, 0, 0},  {0, -1, 0}};
  Random random(2);
  for (int k = 0; k < 200; ++k) dirs.push_back(random.direction());
  for (const glm::dvec3& dir : dirs) {
    std::array<double, coefficientCount(kMaxBasisOrder)> y;
    std::array<float, coefficientCount(kMaxBasisOrder)> y_float;
    evaluate(kMaxBasisOrder, dir, y);
    evaluate(kMaxBasisOrder, glm::vec3(dir), y_float);
    for (int l = 0; l < kMaxBasisOrder; ++l) {
      double energy = 0, energy_float = 0;
      for (int i = l * l; i < (l + 1) * (l + 1); ++i) {
        energy += y[static_cast<std::size_t>(i)] * y[static_cast<std::size_t>(i)];
        const double value = static_cast<double>(y_float[static_cast<std::size_t>(i)]);
        energy_float += value * value;
      }
      EXPECT_NEAR(energy, (2 * l + 1) / (4 * kPi), 1e-14);
      // Rounding the direction to float shifts band l by up to about l 2^-24 of itself, and so does the
      // recurrence.
      const double expected = (2 * l + 1) / (4 * kPi);
      EXPECT_NEAR(energy_float, expected, std::max(2e-6, 2.9e-7 * l * expected));
    }
  }
}

TEST(ShBasis, EvaluatesBatchesAsSingleDirections) {
  Random random(3);
  for (std::size_t count : {1u, 7u, 8u, 9u, 64u, 100u}) {
    std::vector<float> x, y, z;
    for (std::size_t k = 0; k < count; ++k) {
      const glm::vec3 dir(random.direction());
      x.push_back(dir.x);
      y.push_back(dir.y);
      z.push_back(dir.z);
    }
    for (int order = 1; order <= kMaxBasisOrder; ++order) {
      const std::size_t stride = count + 3, entries = static_cast<std::size_t>(coefficientCount(order));
      std::vector<float> batch(entries * stride, 77.0f), one(entries);
      evaluateBatch(order, x.data(), y.data(), z.data(), count, batch.data(), stride);
      for (std::size_t k = 0; k < count; ++k) {
        evaluate(order, glm::vec3(x[k], y[k], z[k]), one);
        // The operations are the same; only fused multiply-adds may differ.
        for (std::size_t i = 0; i < entries; ++i) EXPECT_NEAR(batch[i * stride + k], one[i], 3e-6f);
      }
      for (std::size_t i = 0; i < entries; ++i)
        EXPECT_EQ(batch[i * stride + count], 77.0f) << "wrote past the batch";
    }
  }
}

TEST(ShLightVector, AddsAndScalesAsFunctionsDo) {
  const glm::vec3 dir(0.36f, 0.48f, -0.8f);
  const LightVector disc = discLight(5, {0, 1, 0}, 0.5, {1, 2, 3});
  const LightVector sky = constantLight(3, {0.5f, 0.25f, 0});
  const LightVector sum = 2.0f * disc + sky * glm::vec3(2, 4, 8);
  EXPECT_EQ(sum.order, 5);
  const glm::vec3 expected = 2.0f * disc.evaluate(dir) + glm::vec3(1, 1, 0);
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(sum.evaluate(dir)[channel], expected[channel], 1e-6f);
}

}  // namespace
}  // namespace lambent::sh
