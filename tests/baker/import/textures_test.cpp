// Tests images as textures, and texture coordinates as places of transfer.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "baker/import/image.hpp"
#include "baker/import/texture_transfer.hpp"
#include "tests/support/shapes.hpp"

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

bundle::MeshData unwrapped() {
  return testing::grid({0, 0, 0}, 1.0f, 3);
}

TEST(TextureTransfer, TakesCoordinatesInWhichEveryPointHasAPlaceOfItsOwn) {
  EXPECT_EQ(faultOfCharts(unwrapped(), 0, 128), "");
}

TEST(TextureTransfer, RefusesCoordinatesThatDoNotServe) {
  struct Case {
    const char* says;
    glm::vec2 corner;  // of the grid's first vertex
  };
  for (const Case& bent : {Case{"leaves the texture", {-0.5f, 0.0f}},
                           Case{"leaves the texture", {std::numeric_limits<float>::quiet_NaN(), 0.0f}},
                           Case{"leaves the texture", {std::numeric_limits<float>::infinity(), 0.0f}},
                           Case{"overlaps", {0.9f, 0.9f}}, Case{"no area", {1.0f / 3.0f, 0.0f}}}) {
    bundle::MeshData mesh = unwrapped();
    mesh.texcoords0.front() = bent.corner;
    ScenePrimitive primitive{.mesh = mesh};
    std::vector<std::string> warnings;
    giveTexels(64, "mesh 7, primitive 2", primitive, warnings);
    EXPECT_EQ(primitive.texels, 0u) << bent.says;
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find(bent.says), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find("mesh 7, primitive 2"), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find("unwrap"), std::string::npos) << warnings[0];
  }
}

TEST(TextureTransfer, PrefersTheSecondSetAndNeedsOne) {
  ScenePrimitive primitive{.mesh = unwrapped()};
  std::vector<std::string> warnings;
  primitive.mesh.texcoords1 = primitive.mesh.texcoords0;
  for (glm::vec2& tiled : primitive.mesh.texcoords0) tiled *= 8.0f;
  giveTexels(64, "mesh", primitive, warnings);
  EXPECT_EQ(primitive.texels, 64u);
  EXPECT_EQ(primitive.texel_set, 1u);
  EXPECT_TRUE(warnings.empty());

  ScenePrimitive bare{.mesh = unwrapped()};
  bare.mesh.texcoords0.clear();
  giveTexels(64, "mesh", bare, warnings);
  EXPECT_EQ(bare.texels, 0u);
  EXPECT_EQ(warnings.size(), 1u);
}

TEST(TextureTransfer, IsAPowerOfTwoOfAPrimitiveOrItsMesh) {
  const auto asking = [](const nlohmann::json& texels) {
    return nlohmann::json{{"extras", {{"lambent", {{"texture_transfer", texels}}}}}};
  };
  const nlohmann::json none = nlohmann::json::object();
  for (const nlohmann::json& wrong : {nlohmann::json(0), nlohmann::json(3), nlohmann::json(65536),
                                      nlohmann::json(-64), nlohmann::json(64.5), nlohmann::json("64")})
    EXPECT_THROW(checkTextureTransfer(asking(wrong), "mesh 0"), Error) << wrong.dump();
  for (const std::uint32_t right : {16u, 256u, 2048u}) {
    const nlohmann::json owner = asking(right);
    EXPECT_NO_THROW(checkTextureTransfer(owner, "mesh 0"));
    EXPECT_EQ(textureTransferOf(owner, none), right);
    EXPECT_EQ(textureTransferOf(asking(32), owner), right) << "the primitive's own goes first";
  }
  EXPECT_EQ(textureTransferOf(none, none), 0u);
}

}  // namespace
}  // namespace lambent::baker
