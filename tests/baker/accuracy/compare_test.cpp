#include "baker/accuracy/compare.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace lambent::baker {

namespace {

spec::RgbaImage filled(glm::vec3 color, std::uint32_t width = 8, std::uint32_t height = 4) {
  return {width, height, std::vector<glm::vec4>(std::size_t{width} * height, glm::vec4(color, 1.0f))};
}

TEST(ComparePictures, CountsOnlyWhatAllPicturesCover) {
  auto picture = filled({1, 1, 1});
  const auto reference = filled({1, 1, 1});
  picture.texels[3] = glm::vec4(100.0f, 0.0f, 0.0f, 0.0f);  // sky
  auto error = comparePictures(picture, reference, nullptr, "a.exr");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->pixels, 31u);
  EXPECT_EQ(error->pixels_apart, 1u);
  EXPECT_EQ(error->relative_rms, 0.0);
  EXPECT_EQ(error->largest, 0.0);
  picture.texels[3].w = 1.0f;
  error = comparePictures(picture, reference, nullptr, "a.exr");
  EXPECT_EQ(error->pixels, 32u);
  EXPECT_GT(error->largest, 50.0);
  EXPECT_NEAR(error->bias[1], -1.0 / 32.0, 1e-9);
  EXPECT_EQ(error->median, 0.0);
}

TEST(ComparePictures, LeavesOutTheRimsOfCloudsWhereverTheyFallUnderTheBound) {
  auto picture = filled({1, 1, 1}), reference = filled({1, 1, 1});
  const auto fade = [&](std::size_t i, float a, float b) {
    picture.texels[i] = glm::vec4(5, 5, 5, a);
    reference.texels[i].w = b;
  };
  constexpr float kLeast = spec::kLeastCoverage;
  fade(0, 0.9f * kLeast, 1.1f * kLeast);
  fade(1, 1.1f * kLeast, 0.9f * kLeast);
  fade(2, 1e-7f, 0.0f);
  auto error = comparePictures(picture, reference, nullptr, "a.exr");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->pixels, 29u);
  EXPECT_EQ(error->pixels_apart, 0u);
  EXPECT_EQ(error->largest, 0.0);
  fade(2, 0.3f, 0.0f);
  fade(3, 1.1f * kLeast, 1.0f);
  error = comparePictures(picture, reference, nullptr, "a.exr");
  EXPECT_EQ(error->pixels, 29u);
  EXPECT_EQ(error->pixels_apart, 1u);
  EXPECT_NEAR(error->largest, 4.0, 1e-6);
}

TEST(ComparePictures, OfATexturedErrorRecoversItUnderNoiseThatIsLarger) {
  // The picture has a known error per pixel, and two references have 20 % noise each. The test bounds the
  // error of the figure.
  std::mt19937 random(11);
  std::normal_distribution<float> noise(0.0f, 0.2f);
  constexpr std::uint32_t kSide = 256;
  spec::RgbaImage picture{kSide, kSide, {}}, a = picture, b = picture, truth = picture;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const float x = static_cast<float>(i % kSide) / kSide, y = static_cast<float>(i / kSide) / kSide;
    const glm::vec3 real(1.0f + x, 1.0f + y, 0.5f), shown = real * (1.0f + 0.06f * std::sin(40.0f * x));
    const auto noisy = [&] { return real * (1.0f + glm::vec3(noise(random), noise(random), noise(random))); };
    truth.texels.emplace_back(real, 1.0f);
    picture.texels.emplace_back(shown, 1.0f);
    a.texels.emplace_back(noisy(), 1.0f);
    b.texels.emplace_back(noisy(), 1.0f);
  }
  const auto known = comparePictures(picture, truth, nullptr, "a.exr"),
             seen = comparePictures(picture, a, &b, "a.exr");
  ASSERT_TRUE(known && seen);
  EXPECT_NEAR(known->relative_rms, 0.06 / std::sqrt(2.0), 0.001);
  EXPECT_NEAR(std::pow(seen->relative_rms, 2.0), std::pow(known->relative_rms, 2.0),
              4.0 * seen->relative_square_error);
  EXPECT_LT(4.0 * seen->relative_square_error, 0.5 * std::pow(known->relative_rms, 2.0));
  EXPECT_GT(comparePictures(picture, a, nullptr, "a.exr")->relative_rms, 0.19);
}

constexpr float kNone = std::numeric_limits<float>::infinity();

// Does the same, with a surface at this distance in all pixels.
spec::RgbaImage filledAt(float depth, glm::vec3 color) {
  auto image = filled(color);
  image.depths.assign(image.texels.size(), depth);
  return image;
}

TEST(ComparePictures, LeavesOutPixelsWhoseDepthsDifferAndSaysHowMany) {
  // Three pixels show another surface, in another colour, each in another picture; five show the same
  // surface, 10 % too bright.
  auto picture = filledAt(2.0f, {1, 1, 1}), a = picture, b = picture;
  const auto another = [](spec::RgbaImage& image, std::size_t i, float depth) {
    image.texels[i] = glm::vec4(3, 3, 3, 1);
    image.depths[i] = depth;
  };
  for (std::size_t i = 0; i < 5; ++i) picture.texels[i] = glm::vec4(1.1f, 1.1f, 1.1f, 1);
  another(picture, 5, 2.01f);
  another(a, 6, 1.0f);
  another(b, 7, kNone);
  const auto error = comparePictures(picture, a, &b, "a.exr");
  ASSERT_TRUE(error) << error.error().line();
  EXPECT_EQ(error->pixels, 32u);
  EXPECT_EQ(error->pixels_of_other_surfaces, 3u);
  ASSERT_TRUE(error->same_surface_rms);
  EXPECT_NEAR(*error->same_surface_rms, std::sqrt(5 * 0.01 / 29.0), 1e-6);
}

TEST(ComparePictures, TakesNothingForTheSameAsNothing) {
  // Such pixels occur behind a blended surface, or in a cloud.
  auto picture = filledAt(kNone, {1, 1, 1});
  const auto reference = picture;
  picture.depths[0] = 1e30f;
  picture.depths[1] = std::numeric_limits<float>::quiet_NaN();
  const auto error = comparePictures(picture, reference, &reference, "a.exr");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->pixels_of_other_surfaces, 2u);
  EXPECT_EQ(error->same_surface_rms, 0.0);
}

TEST(ComparePictures, RefusesWhatCannotBeCompared) {
  const auto white = filled({1, 1, 1});
  EXPECT_FALSE(comparePictures(white, filled({1, 1, 1}, 4, 8), nullptr, "a.exr"));
  const auto small = filled({1, 1, 1}, 4, 4);
  EXPECT_FALSE(comparePictures(white, white, &small, "a.exr"));
  EXPECT_FALSE(comparePictures(white, filled({0, 0, 0}), nullptr, "a.exr"));
  auto broken = white;
  broken.texels[9].y = std::numeric_limits<float>::quiet_NaN();
  const auto error = comparePictures(broken, white, nullptr, "a.exr");
  ASSERT_FALSE(error);
  EXPECT_NE(error.error().problem.find("pixel 1, 1"), std::string::npos) << error.error().line();
  for (glm::vec4& texel : broken.texels) texel.w = 0.0f;
  EXPECT_FALSE(comparePictures(broken, white, nullptr, "a.exr"));
}

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

using Color = std::array<std::uint8_t, 3>;

spec::RgbaImage grey(float radiance, std::uint32_t width = 10, std::uint32_t height = 10) {
  return filled(glm::vec3(radiance), width, height);
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
  const auto out = differenceOf(picture, grey(1.0f), nullptr, 0.2, "a.exr");
  ASSERT_TRUE(out) << out.error().line();
  EXPECT_EQ(out->range, 0.2);
  const Color right = at(*out, 0), bright = at(*out, 3), dark = at(*out, 4);
  EXPECT_TRUE(right[0] == right[1] && right[1] == right[2] && right[0] > 240);
  EXPECT_GT(bright[0], 2 * bright[2]);
  EXPECT_GT(dark[2], 2 * dark[0]);
  expectNear(at(*out, 5), heatColor(0.5));
  EXPECT_EQ(at(*out, 6), bright) << "beyond the range";
}

TEST(Difference, MeasuresDarkPixelsByAFloor) {
  // A picture of half 2, half 1e-4: the RMS luminance is sqrt(2).
  auto reference = grey(2.0f);
  for (std::size_t i = 0; i < 50; ++i) set(reference, i, 1e-4f);
  auto picture = reference;
  set(picture, 7, 1e-4f + 0.5f * 0.05f * std::sqrt(2.0f));
  const auto out = differenceOf(picture, reference, nullptr, 1.0, "a.exr");
  ASSERT_TRUE(out);
  expectNear(at(*out, 7), heatColor(0.5));
}

TEST(Difference, ChoosesARangeThatHoldsAllButTheWorstPixels) {
  auto picture = grey(1.0f, 100, 10);
  for (std::size_t i = 0; i < 500; ++i) set(picture, i, 1.13f);
  for (std::size_t i = 0; i < 9; ++i) set(picture, i, 50.0f);  // fewer than one in a hundred
  const auto out = differenceOf(picture, grey(1.0f, 100, 10), nullptr, {}, "a.exr");
  ASSERT_TRUE(out);
  EXPECT_NEAR(out->range, 0.2, 1e-9) << "13 %, rounded up";
  const auto same = differenceOf(picture, picture, nullptr, {}, "a.exr");
  ASSERT_TRUE(same);
  EXPECT_GT(same->range, 0.0);
}

// A grey picture of 64 x 64 pixels, whose left half may have another grey.
spec::Rgba8Image twoGreys(std::uint8_t left, std::uint8_t right) {
  spec::Rgba8Image picture{64, 64, {}};
  for (int i = 0; i < 64 * 64; ++i) {
    const std::uint8_t value = i % 64 < 32 ? left : right;
    picture.texels.insert(picture.texels.end(), {value, value, value, 255});
  }
  return picture;
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
