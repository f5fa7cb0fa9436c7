// Tests how the change around a body is coded within a limit of bytes.
#include "baker/effects/neighborhood/code_change.hpp"

#include <random>

#include <gtest/gtest.h>

#include "baker/jobs/progress.hpp"

namespace lambent::baker {
namespace {

// Bounced light in which noise of few rays takes as many components as there are values.
GridChange noisyChange(const GridPlacement& grid) {
  GridChange change;
  change.shape = {.order = 5, .order_out = 5, .channels = 1};
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0.0f, 1e-3f);
  const std::size_t size = change.shape.bouncedSize();
  change.visibility.assign(grid.count() * change.shape.visibilitySize(), 0.0f);
  change.outside.assign(grid.count(), 1);
  for (std::size_t p = 0; p < grid.count(); ++p)
    for (std::size_t i = 0; i < size; ++i) {
      const float near = 1.0f / (1.0f + glm::length(grid.point(p)));
      change.bounced.push_back((i == 0 ? 0.5f * near : 0.0f) + near * noise(random));
    }
  return change;
}

// Returns the bytes of a point's codes before compression, which makes noise little smaller.
double codeBytes(const CodedChange& change, const GridPlacement& grid) {
  double bytes = 0.0;
  for (const CodedCell& cell : change.cells)
    for (const CodedTransfer& part : cell.transfers)
      for (const CodedPlane& plane : part.planes)
        bytes += static_cast<double>(plane.codes.size() * plane.bits / 8);
  return bytes / static_cast<double>(grid.count());
}

TEST(CodedChange, OfNoiseThatComponentsDoNotHoldKeepsTheLimitOfBytesAndUsesIt) {
  constexpr double kLimit = 43.0, kCompression = 1.5;
  const GridPlacement grid{.size = {16, 8, 16}, .box = {glm::vec3(-2.0f), glm::vec3(2.0f)}};
  const GridChange change = noisyChange(grid);
  Progress progress;
  CachedCoding coding(BakeContext{progress});
  const auto code = [&](double most_bytes) {
    return codeChange(change, grid, glm::vec3(0.0f), {.bound = 1e-5, .most_bytes = most_bytes}, coding,
                      progress);
  };
  const auto all = code(1e9), limited = code(kLimit);
  ASSERT_TRUE(all && limited);
  EXPECT_GT(codeBytes(*all, grid), 2.0 * kLimit);
  EXPECT_LT(codeBytes(*limited, grid), kCompression * kLimit);
  EXPECT_GT(codeBytes(*limited, grid), 0.3 * kLimit);
  EXPECT_LT(limited->error, 3.0 * all->error);
}

}  // namespace
}  // namespace lambent::baker
