#include <gtest/gtest.h>

#include "editor/session/viewing.hpp"

namespace lambent::editor {
namespace {

TEST(PictureScale, IsCoarseOnlyWhileSlowPicturesMove) {
  PictureScale scale;
  scale.drawn(/*moves=*/true);
  EXPECT_EQ(scale.now(), 1.0f) << "nothing is known to be slow";
  scale.wholeTook(320.0);
  scale.drawn(/*moves=*/true);
  EXPECT_NEAR(scale.now(), 0.5f, 1e-6f) << "a quarter of the pixels in a quarter of the time";
  EXPECT_TRUE(scale.settle());
  EXPECT_EQ(scale.now(), 1.0f);
  EXPECT_FALSE(scale.settle());
}

TEST(PictureScale, StaysWholeWherePicturesAreFast) {
  PictureScale scale;
  scale.whole = 2.0f;
  scale.wholeTook(320.0);
  scale.wholeTook(100.0);
  scale.drawn(/*moves=*/true);
  EXPECT_FALSE(scale.coarse());
  EXPECT_EQ(scale.now(), 2.0f);
}

TEST(PictureScale, LeavesAQuarterAlongEachEdgeAtLeast) {
  PictureScale scale;
  scale.wholeTook(60000.0);
  scale.drawn(/*moves=*/true);
  EXPECT_EQ(scale.now(), 0.25f);
}

}  // namespace
}  // namespace lambent::editor
