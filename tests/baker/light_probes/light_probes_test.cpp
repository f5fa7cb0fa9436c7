#include "baker/light_probes/light_probes.hpp"

#include <array>
#include <map>
#include <numeric>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/jobs/parallel.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/description.hpp"
#include "tests/support/differences.hpp"

namespace lambent::baker {
namespace {

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
  SampleSet dot;
  dot.positions = {{1, 2, 3}};
  dot.cells = {{0, 1, {1, 2, 3}, {1, 2, 3}}};
  LightProbes found = choose(dot, {32, false});
  EXPECT_EQ(found.points, dot.positions);
  expectSound(found, dot);

  SampleSet pile;
  pile.positions.assign(100, glm::vec3(-4.0f));
  pile.cells = {{0, 60, glm::vec3(-4.0f), glm::vec3(-4.0f)}, {60, 40, glm::vec3(-4.0f), glm::vec3(-4.0f)}};
  found = choose(pile, {32, false});
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
