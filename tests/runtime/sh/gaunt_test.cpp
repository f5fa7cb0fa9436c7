#include "runtime/sh/gaunt.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/sh/basis.hpp"
#include "tests/runtime/sh/sphere.hpp"

namespace lambent::sh {
namespace {

using testing::Random;

std::size_t countOf(int bands) {
  return static_cast<std::size_t>(coefficientCount(bands));
}

std::vector<float> randomFunction(Random& random, int bands) {
  std::vector<float> f(countOf(bands));
  for (float& c : f) c = static_cast<float>(2 * random.uniform() - 1);
  return f;
}

// V = c: M = c times the identity; open points transfer light as it is.
TEST(Gaunt, TakesFullVisibilityToTheIdentity) {
  for (const auto& [in, out] : {std::pair{5, 5}, {6, 6}, {3, 5}, {6, 4}}) {
    const GauntTable table = makeGauntTable(in, out);
    std::vector<float> visibility(countOf(table.visibilityBands())), matrix(countOf(in) * countOf(out), 2.0f);
    visibility[0] = static_cast<float>(std::sqrt(4 * std::numbers::pi));
    addVisibilityMatrix(table, visibility, matrix);
    for (std::size_t i = 0; i < countOf(out); ++i)
      for (std::size_t j = 0; j < countOf(in); ++j)
        EXPECT_NEAR(matrix[i * countOf(in) + j], i == j ? 3.0f : 2.0f, 1e-6f) << i << ", " << j;
  }
}

// Compares (V L)_i with quadrature of the product itself.
TEST(Gaunt, MultipliesAsQuadratureDoes) {
  Random random(11);
  for (const auto& [in, out] : {std::pair{2, 2}, {4, 4}, {5, 5}, {5, 3}, {4, 6}, {6, 6}, {5, 9}}) {
    const GauntTable table = makeGauntTable(in, out);
    const auto light = randomFunction(random, in),
               visibility = randomFunction(random, table.visibilityBands());
    std::vector<float> matrix(countOf(in) * countOf(out));
    addVisibilityMatrix(table, visibility, matrix);
    std::vector<double> expected(countOf(out));
    testing::overSphere(64, [&](const glm::dvec3& dir, double weight) {
      std::vector<double> y(countOf(kMaxBasisOrder));
      evaluate(kMaxBasisOrder, dir, y);
      double l = 0, v = 0;
      for (std::size_t k = 0; k < light.size(); ++k) l += static_cast<double>(light[k]) * y[k];
      for (std::size_t k = 0; k < visibility.size(); ++k) v += static_cast<double>(visibility[k]) * y[k];
      for (std::size_t k = 0; k < expected.size(); ++k) expected[k] += weight * l * v * y[k];
    });
    for (std::size_t i = 0; i < expected.size(); ++i) {
      double transferred = 0;
      for (std::size_t j = 0; j < light.size(); ++j)
        transferred += static_cast<double>(matrix[i * light.size() + j]) * static_cast<double>(light[j]);
      EXPECT_NEAR(transferred, expected[i], 2e-6 * (1 + std::abs(expected[i])))
          << in << ", " << out << ": " << i;
    }
  }
}

}  // namespace
}  // namespace lambent::sh
