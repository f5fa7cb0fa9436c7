#include <algorithm>
#include <numeric>

#include <glm/vec3.hpp>
#include <gtest/gtest.h>

#include "baker/effects/diffuse/hemisphere.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {
namespace {

std::vector<double> evenly(const DirectionTable& table) {
  return std::vector<double>(table.size(), 1.0 / static_cast<double>(table.size()));
}

class ProjectionTableOfOrder : public ::testing::TestWithParam<std::tuple<int, int>> {};

TEST_P(ProjectionTableOfOrder, IsExactWhereTheAnswerIsKnown) {
  const auto [order, rays] = GetParam();
  const DirectionTable directions = cosineTable(static_cast<std::size_t>(rays));
  const ProjectionTable table(directions, evenly(directions), order);
  const auto columns = static_cast<std::size_t>(sh::coefficientCount(order));
  std::vector<float> open(columns), out(columns);
  sh::unoccludedTransfer(order, glm::vec3(0.0f, 0.0f, 1.0f), open);

  table.project(std::vector<std::uint16_t>(directions.packets(), 0), out);
  for (std::size_t i = 0; i < columns; ++i) EXPECT_NEAR(out[i], open[i], 1e-7f);
  table.project(std::vector<std::uint16_t>(directions.packets(), 0xffff), out);
  EXPECT_EQ(out, std::vector<float>(columns, 0.0f));

  // What one side of the hemisphere lacks, the other has; the two are summed in different ways. 1e-5: float
  // sums.
  std::vector<std::uint16_t> left(directions.packets()), right(directions.packets());
  for (std::size_t r = 0; r < directions.size(); ++r)
    (directions.x[r] < 0.3f ? left : right)[r / 16] |= static_cast<std::uint16_t>(1u << (r % 16));
  std::vector<float> a(columns), b(columns);
  table.project(left, a);
  table.project(right, b);
  for (std::size_t i = 0; i < columns; ++i) EXPECT_NEAR(a[i] + b[i], open[i], 1e-5f) << i;
}

// A negative weight could make uniform light brighter than the albedo.
TEST_P(ProjectionTableOfOrder, WeightsArePositiveAndSumToOne) {
  const auto [order, rays] = GetParam();
  const DirectionTable directions = cosineTable(static_cast<std::size_t>(rays));
  const ProjectionTable table(directions, evenly(directions), order);
  const auto weights = table.weights();
  EXPECT_GT(*std::min_element(weights.begin(), weights.end()), 0.0);
  EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(OrdersAndRays, ProjectionTableOfOrder,
                         ::testing::Combine(::testing::Values(1, 2, 5, 6, 8),
                                            ::testing::Values(128, 512, 2048)));

TEST(CosineTable, HasWholePacketsOfUnitVectorsAboveTheHorizon) {
  for (const std::size_t rays : {1u, 128u, 500u, 2048u}) {
    const DirectionTable table = cosineTable(rays);
    EXPECT_EQ(table.size() % kPacketWidth, 0u);
    EXPECT_GE(table.size(), rays);
    for (std::size_t r = 0; r < table.size(); ++r) {
      EXPECT_GE(table.z[r], 0.0f);
      EXPECT_NEAR(table.x[r] * table.x[r] + table.y[r] * table.y[r] + table.z[r] * table.z[r], 1.0f, 1e-6f);
    }
  }
}

}  // namespace
}  // namespace lambent::baker
