#include <gtest/gtest.h>

#include "baker/accuracy/compare.hpp"

namespace lambent::baker {
namespace {

// A grey picture of 64 x 64 pixels, whose left half may have another grey.
spec::Rgba8Image twoGreys(std::uint8_t left, std::uint8_t right) {
  spec::Rgba8Image picture{64, 64, {}};
  for (int i = 0; i < 64 * 64; ++i) {
    const std::uint8_t value = i % 64 < 32 ? left : right;
    picture.texels.insert(picture.texels.end(), {value, value, value, 255});
  }
  return picture;
}

TEST(Perceptual, EqualPicturesShowNothing) {
  EXPECT_EQ(visibleShare(twoGreys(128, 128), twoGreys(128, 128), "a").value(), 0.0);
}

TEST(Perceptual, OneStepOfEightBitsIsInvisibleAndAHalfInAnotherGreyIsNot) {
  EXPECT_EQ(visibleShare(twoGreys(129, 128), twoGreys(128, 128), "a").value(), 0.0);
  EXPECT_NEAR(visibleShare(twoGreys(220, 128), twoGreys(128, 128), "a").value(), 0.5, 0.1);
}

// One grey level in the other column: the same differences, finer than what an eye resolves.
TEST(Perceptual, FineContrastsHideWhatCoarseOnesShow) {
  const auto striped = [](std::uint8_t step, int stripe) {
    spec::Rgba8Image picture{1024, 64, {}};
    for (int i = 0; i < 1024 * 64; ++i) {
      const auto value = static_cast<std::uint8_t>(128 + (i % 1024 / stripe % 2 == 0 ? step : 0));
      picture.texels.insert(picture.texels.end(), {value, value, value, 255});
    }
    return picture;
  };
  const spec::Rgba8Image plain = striped(0, 1);
  const double fine = visibleShare(striped(8, 1), plain, "a").value();
  const double coarse = visibleShare(striped(8, 32), plain, "a").value();
  EXPECT_LT(fine, 0.1 * coarse);
}

}  // namespace
}  // namespace lambent::baker
