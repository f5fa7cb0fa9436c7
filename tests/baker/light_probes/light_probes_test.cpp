#include "baker/light_probes/light_probes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/jobs/parallel.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/description.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {

namespace {

std::vector<glm::vec3> cloud(std::size_t count, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  std::vector<glm::vec3> points(count);
  for (glm::vec3& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

double meanSquare(const std::vector<glm::vec3>& points, const std::vector<glm::vec3>& centres) {
  double sum = 0.0;
  for (const glm::vec3& p : points) {
    double least = 1e30;
    for (const glm::vec3& c : centres) least = std::min(least, double{glm::dot(p - c, p - c)});
    sum += least;
  }
  return sum / static_cast<double>(points.size());
}

TEST(LightPoints, FindTheMiddlesOfFarClusters) {
  std::vector<glm::vec3> points;
  for (const glm::vec3& middle : {glm::vec3(0, 0, 0), {10, 0, 0}, {0, 10, 0}, {0, 0, 10}})
    for (const glm::vec3& p : cloud(200)) points.push_back(middle + 0.5f * p);
  const auto found = lightPoints(points, std::vector<float>(points.size(), 1.0f), 4);
  ASSERT_EQ(found.size(), 4u);
  for (const glm::vec3& middle : {glm::vec3(0, 0, 0), {10, 0, 0}, {0, 10, 0}, {0, 0, 10}})
    EXPECT_TRUE(std::any_of(found.begin(), found.end(),
                            [&](const glm::vec3& p) { return glm::distance(p, middle) < 0.2f; }));
}

TEST(LightPoints, LieNearerTheMoreThereAre) {
  const auto points = cloud(2000);
  const std::vector<float> areas(points.size(), 1.0f);
  double before = 1e30;
  for (const std::size_t count : {1u, 4u, 8u, 16u, 32u}) {
    const auto found = lightPoints(points, areas, count);
    EXPECT_EQ(found.size(), count);
    const double here = meanSquare(points, found);
    EXPECT_LT(here, before) << count;
    before = here;
  }
  // If each of 32 light probes has an equal part of the cube's 8 m³, the mean square distance is at least
  // that of a ball of this volume, 3/5 r².
  EXPECT_LT(before, 1.4 * 0.6 * std::pow(8.0 / 32 * 0.75 / 3.14159, 2.0 / 3.0));
}

TEST(LightPoints, IgnoreWhatHasNoAreaUnlessNothingHas) {
  const std::vector<glm::vec3> points = {{0, 0, 0}, {1, 0, 0}, {50, 0, 0}};
  EXPECT_EQ(lightPoints(points, std::vector{1.0f, 1.0f, 0.0f}, 8).size(), 2u);
  EXPECT_EQ(lightPoints(points, std::vector{0.0f, 0.0f, 0.0f}, 8).size(), 3u);
}

TEST(MergePoints, LeavesOneOfThoseThatCoincide) {
  std::vector<glm::vec3> points = {{1, 0, 0}, {0, 0, 0}, {1, 1e-4f, 0}, {1, 5, 0}, {0, 0, 1e-4f}};
  mergePoints(points, 1e-3f);
  EXPECT_EQ(points, (std::vector<glm::vec3>{{1, 0, 0}, {0, 0, 0}, {1, 5, 0}}));
}

using testing::Transport;

constexpr double kEps = 1e-6;
constexpr float kDepth = 0.01f;

struct Fitted {
  Transport transport;
  std::vector<float> areas;
  std::vector<glm::vec3> means, points;

  Fitted(const bundle::MeshData& mesh, std::size_t count)
      : transport(testing::sceneOf({mesh})),
        areas(sampleAreas(transport.geometry, transport.samples)),
        means(lightPoints(transport.samples.positions, areas, count)),
        points(means) {
    fitPoints(points, transport.samples, areas, kEps, kDepth);
  }
};

// Returns the root mean square distance between places and the places that their blends represent.
double missed(const Fitted& fit, const std::vector<glm::vec3>& points) {
  double sum = 0.0, areas = 0.0;
  for (std::size_t i = 0; i < fit.areas.size(); ++i) {
    const glm::vec3 place = fit.transport.samples.positions[i];
    const BlendWeights weights = blendWeights(place, points, kEps);
    glm::dvec3 away = -glm::dvec3(place);
    for (std::size_t k = 0; k < 4; ++k) away += weights.weight[k] * glm::dvec3(points[weights.light[k]]);
    sum += double{fit.areas[i]} * glm::dot(away, away);
    areas += double{fit.areas[i]};
  }
  return std::sqrt(sum / areas);
}

TEST(FitPoints, BringsBlendsNearerToTheSurface) {
  for (const std::size_t count : {4u, 8u, 16u, 32u}) {
    const Fitted ball(testing::icosphere({0, 0, 0}, 1.0f, 4), count);
    EXPECT_LT(missed(ball, ball.points), (count == 4 ? 0.96 : 0.85) * missed(ball, ball.means)) << count;
    const Fitted box(testing::box({0, 0, 0}, {2, 1, 1}, 24), count);
    EXPECT_LT(missed(box, box.points), (count == 4 ? 0.96 : 0.85) * missed(box, box.means)) << count;
  }
}

TEST(FitPoints, LeavesThemInsideTheBody) {
  for (const std::size_t count : {4u, 8u, 16u, 32u}) {
    for (const glm::vec3& point : Fitted(testing::icosphere({0, 0, 0}, 1.0f, 4), count).points)
      EXPECT_LT(glm::length(point), 1.0f - 0.9f * kDepth);
    for (const glm::vec3& point : Fitted(testing::box({0, 0, 0}, {2, 1, 1}, 24), count).points)
      EXPECT_TRUE(glm::all(glm::lessThan(glm::abs(point), glm::vec3(1, 0.5f, 0.5f) + 1e-5f)))
          << point.x << " " << point.y << " " << point.z;
  }
}

TEST(FitPoints, OfFewOrCoincidentPointsStayFinite) {
  const Fitted ball(testing::icosphere({0, 0, 0}, 1.0f, 2), 1);
  EXPECT_LT(glm::length(ball.points[0]), 1e-3f);
  std::vector<glm::vec3> same(3, glm::vec3(0.5f, 0, 0));
  fitPoints(same, ball.transport.samples, ball.areas, 0.0, kDepth);
  for (const glm::vec3& point : same) EXPECT_LT(glm::length(point), 1.0f);
  fitPoints(same, ball.transport.samples, std::vector<float>(ball.areas.size(), 0.0f), 0.0, 0.0f);
  for (const glm::vec3& point : same) EXPECT_LT(glm::length(point), 1.0f + 1e-5f);
  SampleSet dot;
  dot.positions = {{1, 2, 3}};
  dot.cells = {{0, 1, {1, 2, 3}, {1, 2, 3}}};
  std::vector<glm::vec3> one = {{0, 0, 0}};
  fitPoints(one, dot, std::vector{1.0f}, 0.0, kDepth);
  EXPECT_LT(glm::distance(one[0], dot.positions[0]), 1e-5f);
}

std::vector<glm::vec3> lights(std::size_t count) {
  return cloud(count, 9);
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

LightProbes choose(const SampleSet& samples, LightProbeCount count) {
  glm::vec3 low(1e30f), high(-1e30f);
  for (const glm::vec3& p : samples.positions) low = glm::min(low, p), high = glm::max(high, p);
  return chooseLightProbes(samples, std::vector<float>(samples.size(), 1.0f), low, high, count);
}

// Makes points of a plane, cut into this many cells along x.
SampleSet strips(std::uint32_t cells, std::uint32_t across) {
  SampleSet samples;
  for (std::uint32_t c = 0; c < cells; ++c) {
    SampleCell cell{.first = static_cast<std::uint32_t>(samples.size()),
                    .count = across * across,
                    .bounds_min = glm::vec3(1e30f),
                    .bounds_max = glm::vec3(-1e30f)};
    for (std::uint32_t i = 0; i < across * across; ++i) {
      const glm::vec3 p = {
          static_cast<float>(c) + (static_cast<float>(i % across) + 0.5f) / static_cast<float>(across), 0.0f,
          (static_cast<float>(i / across) + 0.5f) / static_cast<float>(across)};
      samples.positions.push_back(p);
      cell.bounds_min = glm::min(cell.bounds_min, p), cell.bounds_max = glm::max(cell.bounds_max, p);
    }
    samples.cells.push_back(cell);
  }
  return samples;
}

void expectSound(const LightProbes& found, const SampleSet& samples) {
  ASSERT_EQ(found.cells.size(), samples.cells.size());
  std::vector<bool> used(found.points.size(), false);
  for (const glm::vec3& p : found.points)
    for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(std::isfinite(p[axis]));
  for (std::size_t c = 0; c < found.cells.size(); ++c) {
    const LightProbes::Cell& cell = found.cells[c];
    ASSERT_FALSE(cell.points.empty());
    EXPECT_LE(cell.points.size(), bundle::kMaxLightProbes);
    EXPECT_TRUE(std::is_sorted(cell.points.begin(), cell.points.end()));
    for (const std::uint32_t k : cell.points) used.at(k) = true;
    EXPECT_EQ(cell.weights.size(), cell.points.size() == 1 ? 0u : samples.cells[c].count);
    const auto read = transfer::decodeLightWeights(transfer::encodeLightWeights(cell.weights),
                                                   cell.weights.size(), cell.points.size(), "cell");
    EXPECT_TRUE(read) << read.error().line();
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
}

TEST(LightProbes, AreAsManyAsAskedForOfEachCellOrOfTheGroup) {
  const SampleSet samples = strips(4, 12);
  EXPECT_EQ(choose(samples, {8, false}).points.size(), 32u);
  EXPECT_EQ(choose(samples, {8, true}).points.size(), 8u);
  EXPECT_EQ(choose(samples, {2, true}).points.size(), 4u) << "at least one in each cell";
  for (const std::uint32_t count : {2u, 3u, 16u, 32u}) expectSound(choose(samples, {count, false}), samples);
}

TEST(LightProbes, BlendWithoutASeamWhereCellsMeet) {
  const SampleSet samples = strips(3, 40);
  const LightProbes found = choose(samples, {4, false});
  // Blends a field over the light probes at all places: adjacent places across a cell border differ no more
  // than the largest difference within a cell.
  const auto blended = [&](std::uint32_t c, std::uint32_t i) {
    double sum = 0.0;
    const transfer::LightWeights& w = found.cells[c].weights[i];
    for (std::size_t k = 0; k < 4; ++k) {
      const glm::vec3 p = found.points[found.cells[c].points[w.light[k]]];
      sum += w.weight[k] / 255.0 * (1.0 + std::sin(5.0 * p.x) + p.z);
    }
    return sum;
  };
  double inside = 0.0, across = 0.0;
  for (std::uint32_t row = 0; row < 40; ++row) {
    for (std::uint32_t c = 0; c < 3; ++c)
      for (std::uint32_t i = 0; i + 1 < 40; ++i)
        inside = testing::larger(inside, std::abs(blended(c, row * 40 + i) - blended(c, row * 40 + i + 1)));
    for (std::uint32_t c = 0; c + 1 < 3; ++c)
      across = testing::larger(across, std::abs(blended(c, row * 40 + 39) - blended(c + 1, row * 40)));
  }
  EXPECT_LE(across, inside);
  EXPECT_LT(inside, 0.35)
      << "of a field from 0 to 3, in steps of a twentieth of the way between light probes";
}

TEST(LightProbes, OfPointsThatCoincideOrAreFewAreFewer) {
  SampleSet pile;
  pile.positions.assign(100, glm::vec3(-4.0f));
  pile.cells = {{0, 60, glm::vec3(-4.0f), glm::vec3(-4.0f)}, {60, 40, glm::vec3(-4.0f), glm::vec3(-4.0f)}};
  LightProbes found = choose(pile, {32, false});
  EXPECT_EQ(found.points, std::vector{glm::vec3(-4.0f)});
  expectSound(found, pile);

  SampleSet three;
  three.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  three.cells = {{0, 3, {0, 0, 0}, {1, 1, 0}}};
  found = choose(three, {32, false});
  EXPECT_EQ(found.points.size(), 3u);
  expectSound(found, three);
}

TEST(LightProbes, OfCellsInTheSamePlaceAreShared) {
  SampleSet twice = strips(1, 10);
  const std::vector<glm::vec3> once = twice.positions;
  twice.positions.insert(twice.positions.end(), once.begin(), once.end());
  twice.cells.push_back(twice.cells[0]);
  twice.cells[1].first = twice.cells[0].count;
  const LightProbes found = choose(twice, {8, false});
  EXPECT_EQ(found.points.size(), 8u);
  EXPECT_EQ(found.cells[0].weights, found.cells[1].weights);
}

// Many small cells are in the reach of a wide one, which could use more light probes than a bundle can store.
TEST(LightProbes, AreThinnedWhereACellWouldTakeTooMany) {
  SampleSet samples = strips(1, 30);
  const SampleSet many = strips(1, 30);
  for (std::uint32_t c = 0; c < 20; ++c) {
    SampleCell cell{.first = static_cast<std::uint32_t>(samples.size()), .count = 45};
    cell.bounds_min = glm::vec3(0.0f), cell.bounds_max = {1.0f, 0.0f, 1.0f};
    for (std::uint32_t i = 0; i < 45; ++i)
      samples.positions.push_back(many.positions[45 * c + i] + glm::vec3(0.001f, 0, 0));
    samples.cells.push_back(cell);
  }
  const LightProbes found = choose(samples, {32, false});
  expectSound(found, samples);
  EXPECT_GT(found.points.size(), 1u);
}

}  // namespace

}  // namespace lambent::baker
