#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/streaming/images.hpp"
#include "tests/runtime/streaming/sample_bundle.hpp"

namespace lambent::streaming {
namespace {

TEST(ImageDecode, PngTexelsComeBackExactlyTopRowFirst) {
  const auto rgba = decodeRgba(testing::pngFile(5, 3, 4), "bark");
  ASSERT_TRUE(rgba) << rgba.error().line();
  ASSERT_EQ(rgba->size(), 5u * 3 * 4);
  for (std::uint32_t y = 0; y < 3; ++y) {
    for (std::uint32_t x = 0; x < 5; ++x) {
      for (std::uint32_t c = 0; c < 4; ++c) EXPECT_EQ((*rgba)[(y * 5 + x) * 4 + c], testing::texel(x, y, c));
    }
  }
}

TEST(ImageDecode, JpegIsDecoded) {
  const auto file = testing::jpegFile(16, 8, 100);
  const auto size = imageSize(file, "leaf");
  ASSERT_TRUE(size) << size.error().line();
  EXPECT_EQ(size->width, 16u);
  EXPECT_EQ(size->height, 8u);
  const auto rgba = decodeRgba(file, "leaf");
  ASSERT_TRUE(rgba) << rgba.error().line();
  EXPECT_NEAR((*rgba)[0], 100, 2) << "an even grey loses no more than rounding";
}

TEST(ImageDecode, RefusesAHugeImageByItsHeaderAlone) {
  auto file = testing::pngFile(4, 4, 3);
  file[17] = std::byte{1};  // width, big endian at 16: 65540
  const auto rgba = decodeRgba(file, "image 3 \"bark\"");
  ASSERT_FALSE(rgba);
  EXPECT_NE(rgba.error().line().find("image 3 \"bark\": has 65540 x 4 texels"), std::string::npos)
      << rgba.error().line();
}

TEST(ImageDecode, NamesWhatIsNoImageOrIsCutOff) {
  const std::vector<std::byte> text(100, std::byte{'x'});
  const auto no_image = decodeRgba(text, "bark");
  ASSERT_FALSE(no_image);
  EXPECT_EQ(no_image.error().subject, "bark");
  EXPECT_FALSE(decodeRgba({}, "bark"));
  const auto whole = testing::pngFile(30, 30, 3);
  for (const std::size_t length : {std::size_t{8}, std::size_t{20}, std::size_t{60}, whole.size() / 2}) {
    EXPECT_FALSE(decodeRgba(std::span(whole).first(length), "bark")) << length;
  }
}

}  // namespace
}  // namespace lambent::streaming
