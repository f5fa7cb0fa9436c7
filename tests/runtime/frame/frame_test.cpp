// Tests pictures with known answers, and what a frame may and may not do.
#include "runtime/frame/frame.hpp"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/support/frame/view_stage.hpp"

namespace lambent::frame {
namespace {

using testing::BundleBuilder;
using testing::quadMesh;
using testing::sphereMesh;

using testing::colored;

struct Stage : testing::ViewStage {
  using ViewStage::ViewStage;

  gpu::Counters counts(const std::string& name) {
    const auto found = pass(name);
    EXPECT_TRUE(found) << name;
    return found ? found->counters : gpu::Counters{};
  }
};

const FrameOptions kLinear = [] {
  FrameOptions options;
  options.output = Output::Linear;
  return options;
}();
using testing::kWhite;

glm::vec4 at(const spec::RgbaImage& image, std::uint32_t x, std::uint32_t y) {
  return image.texels[y * image.width + x];
}

std::size_t covered(const spec::RgbaImage& image) {
  return static_cast<std::size_t>(std::count_if(image.texels.begin(), image.texels.end(),
                                                [](const glm::vec4& texel) { return texel.a > 0.5f; }));
}

}  // namespace

using FrameTest = testing::GpuTest;

TEST_F(FrameTest, UniformLightShowsTheAlbedoOfAnOpenSphere) {
  Stage stage(BundleBuilder().add({sphereMesh(24, 48), colored({0.8f, 0.5f, 0.2f, 1.0f})}), {kWhite},
              kLinear);
  const spec::RgbaImage image = stage.picture();
  std::size_t count = 0;
  for (const glm::vec4& texel : image.texels) {
    if (texel.a == 0.0f) {
      // The texels are filtered, so they are equal up to rounding.
      EXPECT_LT(glm::distance(texel, glm::vec4(1.0f, 1.0f, 1.0f, 0.0f)), 1e-6f) << "the sky covers nothing";
      continue;
    }
    ++count;
    // The basis is stored in half floats: 2^-11 relative.
    EXPECT_LT(glm::distance(glm::vec3(texel), glm::vec3(0.8f, 0.5f, 0.2f)), 1e-3f);
  }
  // The box's half diagonal is sqrt(3) radii, the eye 2.5 of these away: the disc's radius is
  // tan(asin(1/4.33)) on a picture of half height tan(20 degrees).
  const double radius =
      std::tan(std::asin(1.0 / (2.5 * std::sqrt(3.0)))) / std::tan(20.0 * 3.14159265 / 180.0) * 32.0;
  EXPECT_NEAR(static_cast<double>(count), 3.14159265 * radius * radius, 0.03 * 64 * 64);
  EXPECT_EQ(stage.frame->negativePixels(), 0u);
}

TEST_F(FrameTest, AStillFrameShadesAndUploadsNothing) {
  Stage stage(
      BundleBuilder().add({sphereMesh(12, 24), colored(glm::vec4(1.0f))}),
      {spec::SunLight{.azimuth_deg = 90, .elevation_deg = 0, .angle_deg = 30, .radiance = glm::vec3(1.0f)}},
      kLinear);
  stage.render();
  EXPECT_EQ(stage.counts("shade").dispatches, 3u) << "cells, samples, vertices";
  EXPECT_EQ(stage.counts("raster").draws, 2u) << "the sphere and the sky";
  stage.render();
  EXPECT_EQ(stage.counts("shade").dispatches, 0u);
  EXPECT_EQ(stage.counts("shade").uploaded_bytes, 0u);
  EXPECT_EQ(stage.counts("light").uploaded_bytes, 0u);
  EXPECT_EQ(stage.counts("raster").uploaded_bytes, 0u);
  stage.camera.azimuth_deg = 40.0f;
  stage.render();
  EXPECT_EQ(stage.counts("shade").dispatches, 0u) << "diffuse light does not depend on the camera";
  stage.environment.setTurn(5.0f);
  stage.render();
  EXPECT_EQ(stage.counts("shade").dispatches, 3u);
}

TEST_F(FrameTest, TheSunLightsTheSideThatFacesItAlsoInTurnedGroupsAndUnderATurnedLight) {
  FrameOptions options = kLinear;
  options.settings.window = sh::Window::Off;  // E/pi of the side that faces it is 8 sin(20 degrees)², 0.94
  const auto builder = BundleBuilder(5)
                           .groupRotation(glm::angleAxis(1.1f, glm::normalize(glm::vec3(1, 2, -1))))
                           .add({sphereMesh(24, 48), colored(glm::vec4(1.0f))});
  Stage stage(
      builder,
      {spec::SunLight{.azimuth_deg = 90, .elevation_deg = 0, .angle_deg = 20, .radiance = glm::vec3(8.0f)}},
      options);
  const auto brightness = [&](std::uint32_t x, std::uint32_t y) { return at(stage.picture(), x, y).g; };
  // Seen from +Z, +X is on the right.
  EXPECT_GT(brightness(43, 32), 0.3f);
  EXPECT_LT(brightness(21, 32), 0.1f);
  // Turned by 90 degrees, +X goes to -Z, behind the camera; by 180 it goes to the left, by -90 to the front.
  stage.environment.setTurn(180.0f);
  EXPECT_GT(brightness(21, 32), 0.3f);
  EXPECT_LT(brightness(43, 32), 0.1f);
  stage.environment.setTurn(-90.0f);
  EXPECT_GT(brightness(32, 32), 0.8f);
  EXPECT_NEAR(brightness(21, 32), brightness(42, 32), 0.02f);
  stage.environment.setTurn(90.0f);
  EXPECT_LT(brightness(32, 32), 0.1f);
}

TEST_F(FrameTest, CullsBackFacesOfSingleSidedMaterialsOnly) {
  gltf::Material both = colored(glm::vec4(1.0f));
  both.double_sided = true;
  for (const bool double_sided : {false, true}) {
    Stage stage(BundleBuilder().add({quadMesh(), double_sided ? both : colored(glm::vec4(1.0f))}), {kWhite},
                kLinear);
    EXPECT_GT(covered(stage.picture()), 500u);
    stage.camera.azimuth_deg = 180.0f;
    EXPECT_EQ(covered(stage.picture()) > 500u, double_sided);
  }
}

TEST_F(FrameTest, LightsEachSideOfATwoSidedCardForItself) {
  // The sun is in front of the card, and its back is turned away, with its own transfer or unshadowed.
  gltf::Material both = colored(glm::vec4(1.0f));
  both.double_sided = true;
  for (const auto transfer : {evaluate::TransferMode::Full, evaluate::TransferMode::Unshadowed}) {
    auto options = kLinear;
    options.settings.transfer = transfer;
    Stage stage(
        BundleBuilder().add({quadMesh(), both}),
        {spec::SunLight{.azimuth_deg = 0, .elevation_deg = 0, .angle_deg = 20, .radiance = glm::vec3(5)}},
        options);
    const auto brightness = [&] { return stage.picture().texels[32 * 64 + 32].g; };
    const float front = brightness();
    stage.camera.azimuth_deg = 180.0f;
    EXPECT_GT(front, 0.3f);
    EXPECT_LT(brightness(), 0.2f * front);
  }
}

TEST_F(FrameTest, MirroredNodesKeepTheirFronts) {
  Stage stage(BundleBuilder().add(
                  {quadMesh(), colored(glm::vec4(1.0f)), glm::scale(glm::mat4(1.0f), glm::vec3(-1, 1, 1))}),
              {kWhite}, kLinear);
  EXPECT_GT(covered(stage.picture()), 500u);
  stage.camera.azimuth_deg = 180.0f;
  EXPECT_EQ(covered(stage.picture()), 0u);
}

TEST_F(FrameTest, TexturesAreUprightAndSrgb) {
  BundleBuilder builder;
  gltf::Material material;
  // Rows from the top: red, green; blue, grey 188 = 0.5029 linear with alpha 0.
  material.base_color_texture.texture =
      builder.addTexture(2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 188, 188, 188, 0},
                         {.wrap_s = GL_CLAMP_TO_EDGE,
                          .wrap_t = GL_CLAMP_TO_EDGE,
                          .mag_filter = GL_NEAREST,
                          .min_filter = GL_NEAREST});
  {
    Stage stage(BundleBuilder(builder).add({quadMesh(), material}), {kWhite}, kLinear);
    const spec::RgbaImage image = stage.picture();
    EXPECT_LT(glm::distance(at(image, 26, 26), glm::vec4(1, 0, 0, 1)), 1e-3f);
    EXPECT_LT(glm::distance(at(image, 37, 26), glm::vec4(0, 1, 0, 1)), 1e-3f);
    EXPECT_LT(glm::distance(at(image, 26, 37), glm::vec4(0, 0, 1, 1)), 1e-3f);
    EXPECT_LT(glm::distance(at(image, 37, 37), glm::vec4(glm::vec3(0.5029f), 1)), 2e-3f)
        << "opaque: alpha ignored";
  }
  material.alpha_mode = gltf::AlphaMode::Mask;
  Stage stage(BundleBuilder(builder).add({quadMesh(), material}), {kWhite}, kLinear);
  const spec::RgbaImage image = stage.picture();
  EXPECT_EQ(at(image, 37, 37).a, 0.0f) << "masked away";
  EXPECT_EQ(at(image, 26, 26).a, 1.0f);
}

TEST_F(FrameTest, BlendsOverWhatStandsBehind) {
  gltf::Material glass = colored({1.0f, 0.0f, 0.0f, 0.25f});
  glass.alpha_mode = gltf::AlphaMode::Blend;
  BundleBuilder builder;
  builder.add({quadMesh(), glass, glm::translate(glm::mat4(1.0f), glm::vec3(0, 0, 0.5f))});
  builder.add({quadMesh(), colored({0.0f, 1.0f, 0.0f, 1.0f}), glm::scale(glm::mat4(1.0f), glm::vec3(0.5f))});
  Stage stage(builder, {kWhite}, kLinear);
  const spec::RgbaImage image = stage.picture();
  EXPECT_LT(glm::distance(at(image, 32, 32), glm::vec4(0.25f, 0.75f, 0.0f, 1.0f)), 2e-3f);
  // Next to the green quad the sky is visible through the glass.
  EXPECT_LT(glm::distance(at(image, 12, 32), glm::vec4(1.0f, 0.75f, 0.75f, 0.25f)), 2e-3f);
}

TEST_F(FrameTest, CountsNegativePixelsAndKeepsTheirSignInLinearPictures) {
  const auto dark = [](const glm::vec3&) { return std::vector<float>(9, -0.1f); };
  Stage stage(BundleBuilder().transfer(dark).add({quadMesh(), colored(glm::vec4(1.0f))}), {kWhite}, kLinear);
  const spec::RgbaImage image = stage.picture();
  EXPECT_EQ(stage.frame->negativePixels(), covered(image));
  EXPECT_GT(covered(image), 0u);
  EXPECT_LT(at(image, 32, 32).r, 0.0f);  // clamped, it could not be held against a reference
}

TEST_F(FrameTest, DisplayPicturesAreExposedAndOpaque) {
  FrameOptions options;
  options.settings.exposure_ev = 0.0f;
  Stage stage(BundleBuilder().add({sphereMesh(12, 24), colored(glm::vec4(glm::vec3(0.5f), 1.0f))}), {kWhite},
              options);
  stage.render();
  const spec::Rgba8Image image = stage.frame->readDisplay();
  const std::size_t centre = 4 * (32 * 64 + 32);
  // The value is 0.5 - 0.04, coded: 1.055 * 0.46^(1/2.4) - 0.055 = 0.708.
  EXPECT_NEAR(image.texels[centre], 181, 2);
  EXPECT_EQ(image.texels[centre + 3], 255);
  EXPECT_EQ(image.texels[3], 255) << "the sky too";
}

TEST_F(FrameTest, ABundleThatStreamsInIsLitFromTheFirstMeshOnAndEndsAtTheSamePicture) {
  const auto builder = BundleBuilder().add({sphereMesh(12, 24), colored(glm::vec4(1.0f))});
  const std::vector<spec::Light> lights = {
      spec::SunLight{.azimuth_deg = 20, .elevation_deg = 40, .angle_deg = 30, .radiance = glm::vec3(4.0f)}};
  Stage whole(builder, lights, kLinear);
  const spec::RgbaImage expected = whole.picture();
  FrameOptions options = kLinear;
  options.upload_budget_bytes = 1;  // one item a frame
  Stage stage(builder, lights, options, /*load=*/false);
  for (int frame = 0; frame < 100'000 && !stage.world.loaded(); ++frame) {
    const spec::RgbaImage image = stage.picture();
    if (covered(image) > 0) {
      EXPECT_GT(at(image, 32, 28).g, 0.1f) << "frame " << frame;
    }
  }
  ASSERT_TRUE(stage.world.loaded());
  const spec::RgbaImage image = stage.picture();
  for (std::size_t i = 0; i < image.texels.size(); ++i) ASSERT_EQ(image.texels[i], expected.texels[i]);
  stage.render();
  EXPECT_EQ(stage.counts("shade").dispatches, 0u);
}

TEST_F(FrameTest, TheWordsOfTransferChooseTheBlock) {
  // The transfer gives a quarter of the light without bounces, three quarters with them, and all light
  // unshadowed.
  const auto transfer = [](const glm::vec3& normal) {
    const std::vector<float> open = testing::openTransfer(3)(normal);
    std::vector<float> blocks;
    for (const float factor : {0.25f, 0.75f})
      for (const float value : open) blocks.push_back(factor * value);
    return blocks;
  };
  const auto builder =
      BundleBuilder().bounces().transfer(transfer).add({sphereMesh(12, 24), colored(glm::vec4(1.0f))});
  using evaluate::TransferMode;
  for (const auto& [mode, expected] : {std::pair{TransferMode::Full, 0.75f},
                                       {TransferMode::Shadowed, 0.25f},
                                       {TransferMode::Unshadowed, 1.0f}}) {
    FrameOptions options = kLinear;
    options.settings.transfer = mode;
    Stage stage(builder, {kWhite}, options);
    EXPECT_NEAR(at(stage.picture(), 32, 32).g, expected, 1e-3f) << "codes of 16 bits";
  }
}

TEST_F(FrameTest, LampsShineAndLightTheirGroupAndDimTogether) {
  gltf::Material glowing = colored({0.5f, 0.5f, 0.5f, 1.0f});
  glowing.emissive = {2.0f, 1.0f, 0.5f};
  // The radiance of an emissive material that is a lamp comes from the lamp, which was baked with another
  // colour.
  const auto builder =
      BundleBuilder()
          .lamp({.kind = bundle::GroupLight::Kind::Material, .index = 0, .color = {4.0f, 1.0f, 0.0f}}, 0.5f)
          .lamp({.kind = bundle::GroupLight::Kind::Node, .index = 0, .color = {0.0f, 0.0f, 8.0f}}, 0.25f)
          .add({sphereMesh(12, 24), glowing});
  FrameOptions options = kLinear;
  options.settings.local_shadows = false;  // these columns are of no light that stands anywhere
  Stage stage(builder, {spec::ConstantLight{.radiance = glm::vec3(0.0f)}}, options);
  const auto expect = [&](float factor) {
    const glm::vec3 emission(4.0f, 1.0f, 0.0f), incident = 0.5f * emission + glm::vec3(0.0f, 0.0f, 2.0f);
    const glm::vec3 found(at(stage.picture(), 32, 32));
    EXPECT_LT(glm::distance(found, factor * (emission + 0.5f * incident)), 1e-3f) << factor;
  };
  expect(1.0f);
  stage.render();
  EXPECT_EQ(stage.counts("shade").dispatches, 0u) << "a still frame";
  stage.world.scaleLamps(0.5f);
  expect(0.5f);
  EXPECT_GT(stage.counts("shade").dispatches, 0u);
  stage.world.scaleLamps(0.0f);
  expect(0.0f);
}

}  // namespace lambent::frame
