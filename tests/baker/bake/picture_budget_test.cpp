// Tests how a bound on the error of pictures is divided among rays, refinement and codes.
#include <cmath>

#include <gtest/gtest.h>

#include "baker/bake/options.hpp"

namespace lambent::baker {
namespace {

TEST(PictureBudget, GivesCodesWhatRaysAndRefinementLeave) {
  for (const float bound : {0.01f, 0.005f}) {
    const bundle::PictureError half{.all = 0.5f * bound};
    EXPECT_NEAR(std::hypot(half.all, codesBound(half, bound)), bound, 0.06f * bound);
    EXPECT_LT(raysFor(2.0f * bound), raysFor(bound));
    EXPECT_GT(refineBoundFor(2.0f * bound), refineBoundFor(bound));
  }
}

TEST(PictureBudget, GivesCodesAnotherBoundWhereEyesSeeMoreOfThem) {
  const bundle::PictureError twice{.all = 0.0128f, .samples = 0.008f, .codes = 0.01f, .points = 1000};
  const auto less = nextCodesBound(0.005f, twice, 0.01f);
  ASSERT_TRUE(less);
  EXPECT_NEAR(*less, 0.0026f, 0.0002f);
  const bundle::PictureError fine{.all = 0.0094f, .samples = 0.008f, .codes = 0.005f, .points = 1000};
  EXPECT_FALSE(nextCodesBound(0.005f, fine, 0.01f));
}

}  // namespace
}  // namespace lambent::baker
