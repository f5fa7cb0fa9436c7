// Tests where grids are placed.
#include "baker/effects/neighborhood/grid_placement.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace lambent::baker {

namespace {

// Returns the far field of a ball of radius 1 at the origin.
double farField(const glm::vec3& p) {
  const double d = double{glm::length(p)};
  return d > 0.0 ? std::min(1.0, 1.0 / (d * d)) : 1.0;
}

PlacementWish ball() {
  PlacementWish wish;
  wish.body = {glm::vec3(-1.0f), glm::vec3(1.0f)};
  return wish;
}

TEST(GridPlacements, ReachAsFarAsTheChangeIsOverTheBound) {
  for (const double bound : {0.01, 0.04, 0.2}) {
    PlacementWish wish = ball();
    wish.bound = bound;
    const auto grid = placeGrid(wish, farField);
    ASSERT_TRUE(grid.has_value());
    EXPECT_EQ(grid->size, glm::uvec3(32));
    // The middle of each face is where it is nearest; probes stand beside it.
    const double distance = 1.0 / std::sqrt(bound), finest = std::sqrt(3.0) * 12.0 / 128.0;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(grid->box.high[axis], distance, finest + 0.01 * distance) << bound;
      EXPECT_NEAR(grid->box.low[axis], -distance, finest + 0.01 * distance) << bound;
    }
    EXPECT_LE(farField({0, grid->box.high.y, 0}), bound * 1.001);
  }
}

TEST(GridPlacements, AreASlabBelowWhereReceiversAreOnlyBelow) {
  PlacementWish wish = ball();
  wish.receivers = Box3{{-50, -4, -50}, {50, -2, 50}};
  const auto grid = placeGrid(wish, farField);
  ASSERT_TRUE(grid.has_value());
  EXPECT_EQ(grid->size, glm::uvec3(64, 8, 64));
  // The box extends beyond the receivers by one to two points.
  EXPECT_LE(grid->box.low.y, -4.0f - grid->spacing().y);
  EXPECT_GE(grid->box.high.y, -2.0f + grid->spacing().y);
  EXPECT_GE(grid->box.low.y, -4.0f - 2.0f * grid->spacing().y);
  EXPECT_LT(grid->box.high.x, 12.0f);
  EXPECT_GT(grid->box.high.x, 8.0f);
}

TEST(GridPlacements, KeepSomeThicknessOverAFlatFloor) {
  PlacementWish wish = ball();
  wish.receivers = Box3{{-50, -1, -50}, {50, -1, 50}};
  const auto grid = placeGrid(wish, farField);
  ASSERT_TRUE(grid.has_value());
  EXPECT_LT(grid->box.low.y, -1.05f);
  EXPECT_GT(grid->box.high.y, -0.95f);
}

TEST(GridPlacements, HaveTheirPointsInFewLayersOverAFlatFloorAndOneOfThemInIt) {
  PlacementWish wish = ball();
  wish.receivers = Box3{{-50, -2, -50}, {50, -2, 50}};
  for (const glm::uvec3& size : {glm::uvec3(0), glm::uvec3(64, 64, 8)}) {
    wish.size = size;
    const auto grid = placeGrid(wish, farField);
    ASSERT_TRUE(grid.has_value());
    EXPECT_EQ(grid->size, glm::uvec3(80, 5, 80));
    EXPECT_LE(grid->count(), 64u * 64u * 8u);
    EXPECT_NEAR(grid->box.low.y + 2.0f * grid->spacing().y, -2.0f, 1e-5f);
    EXPECT_EQ(grid->on_layer, glm::bvec3(false, true, false));
  }
  wish.size = {16, 16, 4};  // few enough as it is
  EXPECT_EQ(placeGrid(wish, farField)->size, glm::uvec3(16, 4, 16));
  EXPECT_EQ(placeGrid(wish, farField)->on_layer, glm::bvec3(false)) << "the floor is between two layers";
  wish.size = {64, 64, 8};
  wish.extent = {8, 8, 1};
  EXPECT_EQ(placeGrid(wish, farField)->size, glm::uvec3(64, 64, 8));
}

TEST(GridPlacements, AreNoneWhereReceiversAreOutOfReach) {
  PlacementWish wish = ball();
  wish.receivers = Box3{{-50, -300, -50}, {50, -200, 50}};
  EXPECT_FALSE(placeGrid(wish, farField).has_value());
}

TEST(GridPlacements, AreNoneForBodiesWithoutSize) {
  PlacementWish wish;
  wish.body = {glm::vec3(3.0f), glm::vec3(3.0f)};
  EXPECT_FALSE(placeGrid(wish, farField).has_value());
}

TEST(GridPlacements, AreAsTheSceneAsksFor) {
  PlacementWish wish = ball();
  wish.body = {glm::vec3(1.0f), glm::vec3(3.0f)};
  wish.size = {64, 64, 8};
  wish.extent = {10.0f, 20.0f, 4.0f};
  const auto grid = placeGrid(wish, farField);
  ASSERT_TRUE(grid.has_value());
  EXPECT_EQ(grid->size, glm::uvec3(64, 64, 8));
  EXPECT_EQ(grid->box.low, glm::vec3(-3.0f, -8.0f, 0.0f));
  EXPECT_EQ(grid->box.high, glm::vec3(7.0f, 12.0f, 4.0f));
  EXPECT_EQ(grid->count(), 64u * 64u * 8u);
  EXPECT_EQ(grid->point(0), grid->box.low);
  EXPECT_NEAR(glm::distance(grid->point(grid->count() - 1), grid->box.high), 0.0f, 1e-5f);
  EXPECT_NEAR(grid->point(1).x, -3.0f + 10.0f / 63.0f, 1e-5f);
}

TEST(GridPlacements, SpreadTheSizeThatIsAskedForEvenlyWhereThereIsNoSlab) {
  PlacementWish wish = ball();
  wish.size = {64, 64, 8};
  EXPECT_EQ(placeGrid(wish, farField)->size, glm::uvec3(32));
  wish.receivers = Box3{{-50, -4, -50}, {50, -2, 50}};
  EXPECT_EQ(placeGrid(wish, farField)->size, glm::uvec3(64, 8, 64));
}

TEST(GridPlacements, DealCountsOutByLength) {
  PlacementWish wish = ball();
  wish.by_length = {4, 40, 20};
  wish.extent = {1.0f, 30.0f, 2.0f};
  EXPECT_EQ(placeGrid(wish, farField)->size, glm::uvec3(4, 40, 20));
}

// Tests that grid points hold the values that interpolate best.

constexpr GridPlacement kGrid{.size = {9, 7, 6}, .box = {{0, 0, 0}, {8, 6, 5}}};

double waves(const glm::vec3& p) {
  return std::cos(0.8 * double{p.x} + 0.3) * std::cos(0.6 * double{p.y} - 0.2) +
         std::sin(0.7 * double{p.z} + 0.5 * double{p.x});
}

template <typename Field>
std::vector<float> sampled(const Field& field) {
  std::vector<float> values;
  for (std::size_t p = 0; p < kGrid.count(); ++p) values.push_back(static_cast<float>(field(kGrid.point(p))));
  return values;
}

// Returns the RMS error of trilinear interpolation, at least a cell away from the faces.
double errorOf(const std::vector<float>& values) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform;
  double square = 0.0;
  constexpr int kPlaces = 2000;
  for (int n = 0; n < kPlaces; ++n) {
    const glm::vec3 at =
        1.0f + glm::vec3(uniform(random), uniform(random), uniform(random)) * glm::vec3(6.0f, 4.0f, 3.0f);
    const glm::uvec3 first(at);
    const glm::vec3 part = at - glm::vec3(first);
    double sum = 0.0;
    for (unsigned corner = 0; corner < 8; ++corner) {
      double weight = 1.0;
      for (int axis = 0; axis < 3; ++axis)
        weight *= double{(corner >> axis & 1u) != 0 ? part[axis] : 1.0f - part[axis]};
      const glm::uvec3 q = first + glm::uvec3(corner & 1u, corner >> 1 & 1u, corner >> 2);
      sum += weight * double{values[q.x + kGrid.size.x * (q.y + std::size_t{kGrid.size.y} * q.z)]};
    }
    square += std::pow(sum - waves(at), 2);
  }
  return std::sqrt(square / kPlaces);
}

const std::vector<std::uint8_t> kAllOutside(kGrid.count(), 1);

TEST(FitBetweenPoints, HalvesTheErrorOfInterpolatingACurvedField) {
  std::vector<float> values = sampled(waves);
  const double before = errorOf(values);
  fitBetweenPoints(kGrid, kAllOutside, 1, values);
  EXPECT_GT(before, 0.02);
  EXPECT_LT(errorOf(values), 0.5 * before);
}

TEST(FitBetweenPoints, LeavesWhatIsLinearAsItIs) {
  const auto linear = [](const glm::vec3& p) { return 1.0f + 2.0f * p.x - 3.0f * p.y + 0.5f * p.z; };
  std::vector<float> values = sampled(linear);
  const std::vector<float> before = values;
  fitBetweenPoints(kGrid, kAllOutside, 1, values);
  for (std::size_t p = 0; p < values.size(); ++p) EXPECT_NEAR(values[p], before[p], 1e-4f) << p;
}

TEST(FitBetweenPoints, ChangesNothingBesideTheBodyNorAlongAxesWhoseLayersReceiversStandOn) {
  const std::vector<float> before = sampled(waves);
  std::vector<std::uint8_t> outside = kAllOutside;
  const std::size_t body = 4 + 9 * (3 + 7 * 2);  // (4, 3, 2)
  outside[body] = 0;
  GridPlacement flat = kGrid;
  flat.on_layer = {false, true, true};
  std::vector<float> values = before;
  fitBetweenPoints(flat, outside, 1, values);
  for (std::size_t p = 0; p < values.size(); ++p) {
    const bool face = p % 9 == 0 || p % 9 == 8, beside = p + 1 >= body && p <= body + 1;
    EXPECT_EQ(values[p] == before[p], face || beside) << p;
  }
}

TEST(FitBetweenPoints, KeepsTheValuesOfAPointApart) {
  std::vector<float> one = sampled(waves), two;
  for (const float value : one) two.insert(two.end(), {value, -2.0f * value});
  fitBetweenPoints(kGrid, kAllOutside, 1, one);
  fitBetweenPoints(kGrid, kAllOutside, 2, two);
  for (std::size_t p = 0; p < one.size(); ++p) {
    EXPECT_FLOAT_EQ(two[2 * p], one[p]);
    EXPECT_FLOAT_EQ(two[2 * p + 1], -2.0f * one[p]);
  }
}

}  // namespace
}  // namespace lambent::baker
