#include <cmath>

#include <gtest/gtest.h>

#include "baker/accuracy/compare.hpp"

namespace lambent::baker {
namespace {

using Color = std::array<std::uint8_t, 3>;

spec::RgbaImage grey(float radiance, std::uint32_t width = 10, std::uint32_t height = 10) {
  return {width, height,
          std::vector<glm::vec4>(std::size_t{width} * height, glm::vec4(glm::vec3(radiance), 1))};
}

Color at(const Difference& difference, std::size_t i) {
  const std::uint8_t* texel = &difference.heat.texels[4 * i];
  EXPECT_EQ(texel[3], 255);
  return {texel[0], texel[1], texel[2]};
}

void set(spec::RgbaImage& image, std::size_t i, float radiance) {
  image.texels[i] = glm::vec4(glm::vec3(radiance), image.texels[i].w);
}

// Colours come from a table of 512 steps.
void expectNear(const Color& seen, const Color& expected) {
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(int{seen[k]}, int{expected[k]}, 2) << k;
}

TEST(Difference, ShowsTooBrightRedTooDarkBlueAndRightWhite) {
  auto picture = grey(1.0f);
  set(picture, 3, 1.2f), set(picture, 4, 0.8f), set(picture, 5, 1.1f), set(picture, 6, 9.0f);
  const auto out = differenceOf(picture, grey(1.0f), nullptr, {.range = 0.2}, "a.exr");
  ASSERT_TRUE(out) << out.error().line();
  EXPECT_EQ(out->range, 0.2);
  const Color right = at(*out, 0), bright = at(*out, 3), dark = at(*out, 4);
  EXPECT_TRUE(right[0] == right[1] && right[1] == right[2] && right[0] > 240);
  EXPECT_GT(bright[0], 2 * bright[2]);
  EXPECT_GT(dark[2], 2 * dark[0]);
  expectNear(at(*out, 5), heatColor(HeatMap::Signed, 0.5));
  EXPECT_EQ(at(*out, 6), bright) << "beyond the range";
}

TEST(Difference, MeasuresDarkPixelsByAFloor) {
  // A picture of half 2, half 1e-4: the RMS luminance is sqrt(2).
  auto reference = grey(2.0f);
  for (std::size_t i = 0; i < 50; ++i) set(reference, i, 1e-4f);
  auto picture = reference;
  set(picture, 7, 1e-4f + 0.5f * 0.05f * std::sqrt(2.0f));
  const auto out = differenceOf(picture, reference, nullptr, {.range = 1.0}, "a.exr");
  ASSERT_TRUE(out);
  expectNear(at(*out, 7), heatColor(HeatMap::Signed, 0.5));
}

TEST(Difference, ChoosesARangeThatHoldsAllButTheWorstPixels) {
  auto picture = grey(1.0f, 100, 10);
  for (std::size_t i = 0; i < 500; ++i) set(picture, i, 1.13f);
  for (std::size_t i = 0; i < 9; ++i) set(picture, i, 50.0f);  // fewer than one in a hundred
  for (const HeatMap map : {HeatMap::Signed, HeatMap::Magnitude}) {
    const auto out = differenceOf(picture, grey(1.0f, 100, 10), nullptr, {.map = map}, "a.exr");
    ASSERT_TRUE(out);
    EXPECT_NEAR(out->range, 0.2, 1e-9) << "13 %, rounded up";
  }
  const auto same = differenceOf(picture, picture, nullptr, {}, "a.exr");
  ASSERT_TRUE(same);
  EXPECT_GT(same->range, 0.0);
}

}  // namespace
}  // namespace lambent::baker
