// Tests the limits of the wheel in lambent-demo.
#include <gtest/gtest.h>

#include "runtime/demo/stage.hpp"

namespace lambent::demo {
namespace {

TEST(Zoom, StopsBeforeTheSurfaceAhead) {
  // The camera is 3 radii from the centre of a ball of radius 1.
  float distance = 3.0f;
  for (int notch = 0; notch < 200; ++notch) distance = zoomed(distance, 1.0f, distance - 1.0f);
  EXPECT_NEAR(distance, 1.0f + kGapRadii, 1e-3f);
  EXPECT_NEAR(zoomed(3.0f, 40.0f, 2.0f), 1.0f + kGapRadii, 1e-5f) << "many notches in one frame, too";
  EXPECT_EQ(zoomed(1.01f, 1.0f, 0.01f), 1.01f) << "nearer than the gap it stays, and is not pushed back";
}

TEST(Zoom, GoesOnWhereNothingIsAheadAndBackFromASurface) {
  EXPECT_FLOAT_EQ(zoomed(2.0f, 1.0f, {}), 2.0f * kZoomPerNotch);
  EXPECT_GT(zoomed(1.0f + kGapRadii, -1.0f, kGapRadii), 1.1f);
  EXPECT_EQ(zoomed(0.1f, 100.0f, {}), kNearestRadii);
}

TEST(Zoom, EndsBeforeTheSceneIsADot) {
  float distance = 3.0f;
  for (int notch = 0; notch < 200; ++notch) distance = zoomed(distance, -1.0f, {});
  EXPECT_EQ(distance, kFarthestRadii);
  EXPECT_EQ(zoomed(40.0f, -1.0f, {}), 40.0f) << "a camera that was put farther away is not pulled in";
}

}  // namespace
}  // namespace lambent::demo
