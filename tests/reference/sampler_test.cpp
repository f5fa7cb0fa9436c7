#include "reference/sampler.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace lambent::baker::reference {
namespace {

TEST(Sampler, FillsEverySquareOfEveryPowerOfTwo) {
  // Owen scrambling preserves Sobol's property: of 4^k points, each of the 2^k x 2^k squares has one, and so
  // has each strip.
  for (std::uint32_t dimension : {0u, 7u, 300u}) {
    const Sampler sampler(1, 2, 0);
    std::array<int, 64> squares{}, columns{}, rows{};
    for (std::uint32_t i = 0; i < 64; ++i) {
      const glm::vec2 u = sampler.pair(dimension, i);
      ASSERT_TRUE(u.x >= 0.0f && u.x < 1.0f && u.y >= 0.0f && u.y < 1.0f);
      ++squares[static_cast<std::size_t>(u.x * 8.0f) * 8 + static_cast<std::size_t>(u.y * 8.0f)];
      ++columns[static_cast<std::size_t>(u.x * 64.0f)];
      ++rows[static_cast<std::size_t>(u.y * 64.0f)];
    }
    for (std::size_t k = 0; k < 64; ++k) EXPECT_TRUE(squares[k] == 1 && columns[k] == 1 && rows[k] == 1) << k;
  }
}

TEST(Sampler, DrawsIndependentNumbersForPixelsDimensionsReplicasAndSeeds) {
  // Correlations of 4096 independent pairs are within 4 / sqrt(4096) of 0.
  constexpr std::uint32_t kCount = 4096;
  const auto correlation = [](auto&& draw) {
    double sum = 0.0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const auto [a, b] = draw(i);
      sum += 12.0 * (double{a} - 0.5) * (double{b} - 0.5) / kCount;
    }
    return std::abs(sum);
  };
  const double bound = 4.0 / std::sqrt(double{kCount});
  const auto at = [](std::uint32_t seed, std::uint32_t pixel, std::uint32_t replica,
                     std::uint32_t dimension) { return Sampler(seed, pixel, replica).pair(dimension, 3).x; };
  using Two = std::pair<float, float>;
  EXPECT_LT(correlation([&](auto i) { return Two{at(0, i, 0, 5), at(0, i + 1, 0, 5)}; }), bound);
  EXPECT_LT(correlation([&](auto i) { return Two{at(0, i, 0, 5), at(0, i, 1, 5)}; }), bound);
  EXPECT_LT(correlation([&](auto i) { return Two{at(0, i, 0, 5), at(1, i, 0, 5)}; }), bound);
  EXPECT_LT(correlation([&](auto i) { return Two{at(0, i, 0, 5), at(0, i, 0, 6)}; }), bound);
  EXPECT_LT(correlation([&](auto i) {
              const glm::vec2 u = Sampler(0, i, 0).pair(5, 3);
              return Two{u.x, u.y};
            }),
            bound);
}

}  // namespace
}  // namespace lambent::baker::reference
