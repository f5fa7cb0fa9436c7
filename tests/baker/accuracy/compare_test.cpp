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

TEST(ComparePictures, OfAPictureWithItselfIsZero) {
  const auto error = comparePictures(filled({1, 2, 3}), filled({1, 2, 3}), nullptr, "a.exr");
  ASSERT_TRUE(error) << error.error().line();
  EXPECT_EQ(error->pixels, 32u);
  EXPECT_EQ(error->relative_rms, 0.0);
  EXPECT_EQ(error->largest, 0.0);
}

TEST(ComparePictures, CountsOnlyWhatAllPicturesCover) {
  auto picture = filled({1, 1, 1});
  const auto reference = filled({1, 1, 1});
  picture.texels[3] = glm::vec4(100.0f, 0.0f, 0.0f, 0.0f);  // sky
  auto error = comparePictures(picture, reference, nullptr, "a.exr");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->pixels, 31u);
  EXPECT_EQ(error->pixels_apart, 1u);
  EXPECT_EQ(error->largest, 0.0);
  picture.texels[3].w = 1.0f;
  error = comparePictures(picture, reference, nullptr, "a.exr");
  EXPECT_EQ(error->pixels, 32u);
  EXPECT_GT(error->largest, 50.0);
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

TEST(ComparePictures, WithTwoReferencesIsFreeOfTheirNoise) {
  // The picture is 2 % too bright, and each reference has 30 % independent noise.
  std::mt19937 random(5);
  std::normal_distribution<float> noise(1.0f, 0.3f);
  const auto noisy = [&] {
    auto image = filled({1, 1, 1}, 512, 512);
    for (glm::vec4& texel : image.texels)
      texel = glm::vec4(noise(random), noise(random), noise(random), 1.0f);
    return image;
  };
  const auto picture = filled({1.02f, 1.02f, 1.02f}, 512, 512);
  const auto a = noisy(), b = noisy();
  const auto one = comparePictures(picture, a, nullptr, "a.exr");
  const auto both = comparePictures(picture, a, &b, "a.exr");
  ASSERT_TRUE(one && both);
  EXPECT_NEAR(one->relative_rms, 0.3 / std::sqrt(1.09), 0.01);
  // The product of the noises averages to 0.09 / sqrt(786432) = 1e-4, against 4e-4 of true error.
  EXPECT_NEAR(both->relative_rms, 0.02, 0.008);
  EXPECT_NEAR(both->bias[1], 0.02, 0.002);
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

}  // namespace
}  // namespace lambent::baker
