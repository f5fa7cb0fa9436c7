#include "baker/sweep/pareto.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace lambent::baker {
namespace {

using Front = std::vector<std::size_t>;

TEST(Pareto, FrontHasWhatNothingBeatsInTheOrderOfCost) {
  //                                   beaten by 2     the cheapest   the most exact   beaten by 2
  const std::vector<CostAndError> points = {{4.0, 0.30}, {1.0, 0.50}, {3.0, 0.20}, {9.0, 0.10}, {9.5, 0.20}};
  EXPECT_EQ(paretoFront(points), (Front{1, 2, 3}));
}

TEST(Pareto, OfEqualPointsTheFirstCounts) {
  const std::vector<CostAndError> points = {{2.0, 0.2}, {1.0, 0.3}, {1.0, 0.3}, {2.0, 0.2}};
  EXPECT_EQ(paretoFront(points), (Front{1, 0}));
}

TEST(Pareto, OfEqualCostTheSmallerErrorCountsAndOfEqualErrorTheSmallerCost) {
  EXPECT_EQ(paretoFront(std::vector<CostAndError>{{1.0, 0.3}, {1.0, 0.2}}), (Front{1}));
  EXPECT_EQ(paretoFront(std::vector<CostAndError>{{2.0, 0.2}, {1.0, 0.2}}), (Front{1}));
}

TEST(Pareto, WhatIsNotFiniteNeverLiesOnTheFront) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  const std::vector<CostAndError> points = {
      {nan, 0.1}, {1.0, nan}, {infinite, 0.0}, {2.0, 0.2}, {-infinite, 0.1}};
  EXPECT_EQ(paretoFront(points), (Front{3}));
  EXPECT_EQ(paretoFront({}), Front{});
}

TEST(Pareto, GainIsTheShareOfErrorThatADoublingOfCostTakesAway) {
  EXPECT_NEAR(gainPerDoubling({1.0, 0.4}, {2.0, 0.3}), 0.25, 1e-12);
  // Two doublings that take half away each.
  EXPECT_NEAR(gainPerDoubling({1.0, 0.4}, {4.0, 0.1}), 0.5, 1e-12);
  EXPECT_EQ(gainPerDoubling({1.0, 0.4}, {1.0, 0.1}), 0.0);  // it does not cost more
}

TEST(Pareto, KneeIsWhereNoLaterPointTakesATenthAwayForEachDoubling) {
  // 1 -> 2 s halves the error, 2 -> 4 s takes 2 % of it away, and so does 4 -> 8 s.
  const std::vector<CostAndError> points = {{1.0, 0.4}, {2.0, 0.2}, {4.0, 0.196}, {8.0, 0.192}};
  EXPECT_EQ(kneeOf(points, paretoFront(points)), 1u);
}

TEST(Pareto, KneeLooksBehindASmallStepToALargeOne) {
  const std::vector<CostAndError> points = {{1.0, 0.40}, {2.0, 0.39}, {4.0, 0.10}};
  EXPECT_EQ(kneeOf(points, paretoFront(points)), 2u);
}

TEST(Pareto, ADifferenceWithinTheSpreadIsNoGain) {
  std::vector<CostAndError> points = {{1.0, 0.40, 0.06}, {2.0, 0.35, 0.06}};
  EXPECT_EQ(kneeOf(points, paretoFront(points)), 0u);
  points[0].spread = points[1].spread = 0.01;
  EXPECT_EQ(kneeOf(points, paretoFront(points)), 1u);
}

TEST(Pareto, NoPointsHaveNoKneeAndOneIsItsOwn) {
  EXPECT_FALSE(kneeOf({}, {}));
  const std::vector<CostAndError> one = {{1.0, 0.4}};
  EXPECT_EQ(kneeOf(one, paretoFront(one)), 0u);
}

}  // namespace
}  // namespace lambent::baker
