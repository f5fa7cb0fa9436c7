// Tests where grids are placed.
#include "baker/effects/neighborhood/grid_placement.hpp"

#include <cmath>

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

}  // namespace
}  // namespace lambent::baker
