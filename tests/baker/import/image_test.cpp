#include "baker/import/image.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace lambent::baker {
namespace {

// The image has 2 x 2 RGBA texels: red, green / blue, white at half alpha.
constexpr unsigned char kPng[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52,
    0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x06, 0x00, 0x00, 0x00, 0x72, 0xb6, 0x0d,
    0x24, 0x00, 0x00, 0x00, 0x16, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8, 0xcf, 0xc0, 0xf0,
    0x1f, 0x0c, 0x81, 0xf4, 0xff, 0x3d, 0x7b, 0xf6, 0x34, 0x00, 0x00, 0x46, 0xee, 0x08, 0xaf, 0xca,
    0x42, 0x5f, 0x63, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

SceneImage png() {
  SceneImage image{.name = "four", .mime_type = "image/png", .file_bytes = {}};
  for (const unsigned char byte : kPng) image.file_bytes.push_back(static_cast<std::byte>(byte));
  return image;
}

TEST(DecodeImage, GivesTexelsAsStoredFromTheTop) {
  const auto image = decodeImage(png());
  ASSERT_TRUE(image) << image.error().line();
  EXPECT_EQ(image->width, 2u);
  EXPECT_EQ(image->height, 2u);
  EXPECT_EQ(image->rgba,
            (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 188, 188, 188, 128}));
}

TEST(NearestData, IsAsStoredWhereColorsAreLinear) {
  const auto image = decodeImage(png());
  ASSERT_TRUE(image);
  const gltf::Sampler sampler;
  const glm::vec4 data = nearestData(*image, sampler, {0.75f, 0.75f}),
                  color = nearestTexel(*image, sampler, {0.75f, 0.75f});
  EXPECT_NEAR(data.r, 188.0f / 255.0f, 1e-6f);
  EXPECT_NEAR(data.a, 128.0f / 255.0f, 1e-6f);
  EXPECT_NEAR(color.r, 0.5f, 0.005f);
  EXPECT_EQ(color.a, data.a);
  EXPECT_EQ(nearestData(*image, sampler, {1.25f, -0.25f}), nearestData(*image, sampler, {0.25f, 0.75f}));
}

TEST(DecodeImage, RefusesDamageByName) {
  const SceneImage whole = png();
  for (std::size_t size = 0; size < whole.file_bytes.size(); ++size) {
    SceneImage image = whole;
    image.file_bytes.resize(size);
    const auto cut = decodeImage(image);
    ASSERT_FALSE(cut) << size;
    EXPECT_NE(cut.error().subject.find("four"), std::string::npos);
  }
}

TEST(SampleImage, IsLinearAtTexelCentresAndBetweenThem) {
  const DecodedImage image = *decodeImage(png());
  gltf::Sampler clamp{.wrap_s = 33071, .wrap_t = 33071};
  EXPECT_EQ(sampleImage(image, clamp, {0.25f, 0.25f}), glm::vec4(1, 0, 0, 1));
  const glm::vec4 gray = sampleImage(image, clamp, {0.75f, 0.75f});
  EXPECT_NEAR(gray.x, 0.503f, 1e-3f);  // sRGB 188
  EXPECT_NEAR(gray.w, 128.0f / 255.0f, 1e-6f);
  EXPECT_EQ(sampleImage(image, clamp, {0.5f, 0.25f}), glm::vec4(0.5f, 0.5f, 0, 1));
}

TEST(SampleImage, WrapsAsTheSamplerSays) {
  const DecodedImage image = *decodeImage(png());
  const gltf::Sampler repeat, clamp{.wrap_s = 33071, .wrap_t = 33071},
      mirror{.wrap_s = 33648, .wrap_t = 33648};
  const glm::vec4 red(1, 0, 0, 1), green(0, 1, 0, 1);
  EXPECT_EQ(sampleImage(image, repeat, {1.25f, 0.25f}), red);
  EXPECT_EQ(sampleImage(image, repeat, {-0.25f, 0.25f}), green);
  EXPECT_EQ(sampleImage(image, clamp, {1.25f, 0.25f}), green);
  EXPECT_EQ(sampleImage(image, mirror, {1.25f, 0.25f}), green);
  EXPECT_EQ(sampleImage(image, mirror, {-0.25f, 0.25f}), red);
  EXPECT_TRUE(std::isfinite(sampleImage(image, repeat, {1e30f, -1e30f}).x));
}

}  // namespace
}  // namespace lambent::baker
