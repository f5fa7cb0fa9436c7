#include <gtest/gtest.h>

#include "baker/accuracy/compare.hpp"

namespace lambent::baker {
namespace {

spec::RgbaImage rising(std::uint32_t width, std::uint32_t height) {
  spec::RgbaImage picture{width, height, {}};
  for (std::uint32_t i = 0; i < width * height; ++i)
    picture.texels.emplace_back(static_cast<float>(i), 1.0f, 0.0f, 1.0f);
  return picture;
}

TEST(Shrunk, PixelsAreMeansOfTheirBlocks) {
  const auto small = shrunk(rising(6, 4), 2, "a.exr");
  ASSERT_TRUE(small) << small.error().line();
  EXPECT_EQ(small->width, 3u);
  EXPECT_EQ(small->height, 2u);
  EXPECT_FLOAT_EQ(small->texels[0].x, (0.0f + 1.0f + 6.0f + 7.0f) / 4.0f);
  EXPECT_FLOAT_EQ(small->texels[5].x, (16.0f + 17.0f + 22.0f + 23.0f) / 4.0f);
  EXPECT_FLOAT_EQ(small->texels[5].y, 1.0f);
}

TEST(Shrunk, CoverageIsAShareAndDepthsAreLeftOut) {
  spec::RgbaImage picture = rising(2, 2);
  picture.texels[3] = glm::vec4(0.0f);
  picture.depths = {1.0f, 2.0f, 3.0f, 4.0f};
  const auto small = shrunk(picture, 2, "a.exr");
  ASSERT_TRUE(small);
  EXPECT_FLOAT_EQ(small->texels[0].w, 0.75f);
  EXPECT_TRUE(small->depths.empty());
  EXPECT_EQ(shrunk(picture, 1, "a.exr")->depths.size(), 4u);
}

}  // namespace
}  // namespace lambent::baker
