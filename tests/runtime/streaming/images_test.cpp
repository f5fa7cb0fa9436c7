#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/streaming/textures.hpp"
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

std::vector<std::uint8_t> texelsOf(const ImageSize& size, auto&& value) {
  std::vector<std::uint8_t> rgba;
  for (std::uint32_t y = 0; y < size.height; ++y)
    for (std::uint32_t x = 0; x < size.width; ++x)
      for (std::uint32_t c = 0; c < 4; ++c) rgba.push_back(value(x, y, c));
  return rgba;
}

TEST(ImageLevels, AreAsOpenGlCountsAndRoundsThem) {
  const ImageSize size{300, 17};
  EXPECT_EQ(levelCount(size), 9u);
  EXPECT_EQ(sizeAt(size, 0).width, 300u);
  EXPECT_EQ(sizeAt(size, 2).width, 75u);
  EXPECT_EQ(sizeAt(size, 2).height, 4u);
  EXPECT_EQ(sizeAt(size, 8).width, 1u);
  EXPECT_EQ(sizeAt(size, 8).height, 1u);
  EXPECT_EQ(coarseLevel(size), 3u) << "37 x 2";
  EXPECT_EQ(coarseLevel({64, 64}), 0u);
  EXPECT_EQ(coarseLevel({65, 1}), 1u);
}

TEST(ImageLevels, MeansOfColoursAreOfTheirLightAndOfNumbersOfTheirCodes) {
  const ImageSize size{8, 8};
  const auto chequered = texelsOf(
      size, [](auto x, auto y, auto) { return static_cast<std::uint8_t>((x + y) % 2 == 0 ? 255 : 0); });
  const auto color = shrink(chequered, size, 1, /*color=*/true);
  const auto numbers = shrink(chequered, size, 1, /*color=*/false);
  ASSERT_EQ(color.size(), 4u * 4 * 4);
  for (std::size_t i = 0; i < color.size(); ++i) {
    EXPECT_EQ(color[i], i % 4 == 3 ? 128 : 188) << "half the light is code 188, coverage is a number";
    EXPECT_EQ(numbers[i], 128);
  }
}

TEST(ImageLevels, OfAnySizeKeepTheMeanAndWhatIsEven) {
  for (const ImageSize size : {ImageSize{7, 5}, ImageSize{1, 9}, ImageSize{16, 3}, ImageSize{33, 64}})
    for (std::uint32_t level = 1; level < levelCount(size); ++level) {
      const auto even =
          texelsOf(size, [](auto, auto, auto c) { return static_cast<std::uint8_t>(40 + 60 * c); });
      const ImageSize small = sizeAt(size, level);
      for (const bool color : {true, false}) {
        const auto found = shrink(even, size, level, color);
        ASSERT_EQ(found.size(), small.rgbaBytes());
        for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], 40 + 60 * (i % 4));
      }
      const auto ramp = texelsOf(
          size, [](auto x, auto y, auto) { return static_cast<std::uint8_t>((37 * x + 11 * y) % 256); });
      const auto meanOf = [](const std::vector<std::uint8_t>& values) {
        double sum = 0.0;
        for (const std::uint8_t value : values) sum += value;
        return sum / static_cast<double>(values.size());
      };
      EXPECT_NEAR(meanOf(shrink(ramp, size, level, /*color=*/false)), meanOf(ramp), 0.5)
          << size.width << " x " << size.height << ", level " << level;
    }
}

}  // namespace
}  // namespace lambent::streaming
