#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/light_probes/light_probes.hpp"
#include "tests/support/differences.hpp"

namespace lambent::baker {
namespace {

constexpr double kEps = 1e-6;

std::vector<glm::vec3> lights(std::size_t count) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  std::vector<glm::vec3> points(count);
  for (glm::vec3& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

std::map<std::uint32_t, double> byLight(const BlendWeights& weights) {
  std::map<std::uint32_t, double> out;
  for (std::size_t k = 0; k < 4; ++k) out[weights.light[k]] += weights.weight[k];
  return out;
}

TEST(BlendWeights, SumToOneAndAreNotNegative) {
  for (const std::size_t count : {1u, 2u, 4u, 5u, 32u}) {
    const auto points = lights(count);
    for (const glm::vec3& place : lights(500)) {
      const BlendWeights weights = blendWeights(place, points, kEps);
      double sum = 0.0;
      for (const double weight : weights.weight) {
        EXPECT_GE(weight, 0.0);
        sum += weight;
      }
      EXPECT_NEAR(sum, 1.0, 1e-12);
    }
  }
}

// Along a path through the cloud no weight jumps, although the light probes in use change: the largest change
// shrinks with the step length.
TEST(BlendWeights, ChangeWithoutAJumpAlongAPath) {
  const auto points = lights(24);
  const auto largestStep = [&](int steps) {
    double largest = 0.0;
    std::map<std::uint32_t, double> before;
    for (int i = 0; i <= steps; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(steps);
      const glm::vec3 place{2.0f * t - 1.0f, std::sin(7.0f * t), 0.3f * std::cos(20.0f * t)};
      auto here = byLight(blendWeights(place, points, kEps));
      if (i > 0)
        for (std::uint32_t k = 0; k < points.size(); ++k)
          largest = testing::larger(largest, std::abs(here[k] - before[k]));
      before = std::move(here);
    }
    return largest;
  };
  const double coarse = largestStep(1000), fine = largestStep(16000);
  EXPECT_LT(coarse, 0.15);
  EXPECT_LT(fine, coarse / 8.0) << "a jump would stay as it is";
}

// Blends of a linear function of space err by less than a fifth of what the nearest light probe alone does,
// wherever light probes are on all sides.
TEST(BlendWeights, FollowEvenChangeAmongLightProbes) {
  const auto points = lights(64);
  double blended = 0.0, nearest = 0.0;
  for (const glm::vec3& unit : lights(500)) {
    const glm::vec3 place = 0.5f * unit;
    const BlendWeights weights = blendWeights(place, points, kEps);
    glm::dvec3 there(0.0);
    for (std::size_t k = 0; k < 4; ++k) there += weights.weight[k] * glm::dvec3(points[weights.light[k]]);
    blended += glm::dot(there - glm::dvec3(place), there - glm::dvec3(place));
    double least = 100.0;
    for (const glm::vec3& point : points)
      least = testing::smaller(least, double{glm::distance(point, place)});
    nearest += least * least;
  }
  EXPECT_LT(std::sqrt(blended / nearest), 0.2);
}

// In the middle of two light probes, and of the corners of a cube, the weights are symmetric and few.
TEST(BlendWeights, OfRegularLightProbesAreFewAndDoNotJump) {
  std::vector<glm::vec3> grid;
  for (int i = 0; i < 27; ++i)
    grid.emplace_back(static_cast<float>(i % 3), static_cast<float>(i / 3 % 3), static_cast<float>(i / 9));
  const BlendWeights half = blendWeights({0.5f, 0, 0}, grid, kEps);
  EXPECT_NEAR(half.weight[0], 0.5, 1e-4);
  EXPECT_NEAR(half.weight[1], 0.5, 1e-4);
  const auto blended = [&](glm::vec3 place) {
    const BlendWeights weights = blendWeights(place, grid, kEps);
    double sum = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const glm::vec3 x = grid[weights.light[k]];
      sum += weights.weight[k] * std::sin(3.0 * x.x + 5.0 * x.y + 7.0 * x.z);
    }
    return sum;
  };
  for (const glm::vec3& unit : lights(2000)) {
    const glm::vec3 place = 1.2f * unit + 1.0f;
    EXPECT_NEAR(blended(place), blended(place + glm::vec3(1e-5f, -1e-5f, 1e-5f)), 1e-3);
  }
}

TEST(BlendWeights, OfCoincidentLightProbesStayFinite) {
  const std::vector<glm::vec3> same(6, glm::vec3(1.0f));
  for (const double eps : {0.0, kEps})
    for (const glm::vec3& place : {glm::vec3(1.0f), glm::vec3(2.0f)}) {
      const BlendWeights weights = blendWeights(place, same, eps);
      EXPECT_DOUBLE_EQ(std::accumulate(weights.weight.begin(), weights.weight.end(), 0.0), 1.0);
    }
}

TEST(QuantizedWeights, SumTo255AndFallAndAreNear) {
  const auto points = lights(32);
  for (const glm::vec3& place : lights(2000)) {
    const BlendWeights weights = blendWeights(place, points, kEps);
    const QuantizedWeights steps = quantized(weights);
    EXPECT_EQ(std::accumulate(steps.weight.begin(), steps.weight.end(), 0), 255);
    auto wanted = byLight(weights);
    for (std::size_t k = 0; k < 4; ++k) {
      if (k > 0) {
        EXPECT_LE(steps.weight[k], steps.weight[k - 1]);
      }
      if (steps.weight[k] > 0) {
        EXPECT_NEAR(steps.weight[k], 255.0 * wanted[steps.light[k]], 1.0);
      }
    }
  }
}

TEST(LightsNear, HoldAllThatCountAtPlacesInTheBox) {
  const auto points = lights(4000);
  const glm::vec3 low(0.6f, -0.8f, 0.7f), high = low + 0.01f;
  const auto near = lightsNear(low, high, points);
  EXPECT_LT(near.size(), 3900u);
  std::vector<glm::vec3> few;
  for (const std::uint32_t k : near) few.push_back(points[k]);
  for (const glm::vec3& unit : lights(300)) {
    const glm::vec3 place = low + (0.5f * unit + 0.5f) * (high - low);
    auto all = byLight(blendWeights(place, points, kEps)), some = byLight(blendWeights(place, few, kEps));
    for (const auto& [k, weight] : some) EXPECT_NEAR(all[near[k]], weight, 1e-6);
  }
}

}  // namespace
}  // namespace lambent::baker
