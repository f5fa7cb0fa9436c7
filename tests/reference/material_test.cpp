// Tests what materials do to rays: cut-outs, blending, unlit, single- and double-sided, textures, normal
// maps.
#include <gtest/gtest.h>

#include "reference/sampler.hpp"
#include "tests/reference/measure.hpp"

namespace lambent::baker::reference {
namespace {

using testing::expectMean;
using testing::Measured;
using testing::measured;
using testing::samples;
using testing::sceneOf;

// Makes a floor and a card at height 1 above it, both facing up.
Scene floorAndCard(const gltf::Material& material, float width = 2.0f) {
  Scene scene = sceneOf({testing::grid({0, 0, 0}, 40.0f, 1), testing::grid({0, 1, 0}, width, 1)});
  testing::paint(scene, 1, material);
  return scene;
}

// Makes a texture of `texels` (RGBA, n wide, 1 high), read without filtering.
gltf::TextureRef stripes(Scene& scene, const std::vector<std::uint8_t>& texels) {
  return testing::addTexture(scene, {static_cast<std::uint32_t>(texels.size() / 4), 1, texels});
}

const spec::Light kZenith = spec::SunLight{.elevation_deg = 90, .angle_deg = 1, .radiance = glm::vec3(1000)};
const float kZenithRadiance = 1000.0f * std::pow(std::sin(glm::radians(1.0f)), 2.0f);

TEST(Material, OfCutOutsLetsRaysThroughByItsTexture) {
  Scene scene = floorAndCard(testing::matte());
  gltf::Material& cut = scene.materials[1];
  cut.alpha_mode = gltf::AlphaMode::Mask;
  cut.base_color_texture = stripes(scene, {255, 255, 255, 255, 255, 255, 255, 100});  // left half stands
  const auto seen = [&](glm::vec3 eye, glm::vec3 target) {
    return measured(scene, eye, target, {kZenith}, samples(16, 0));
  };
  EXPECT_NEAR(seen({-0.5f, 0.5f, 4}, {-0.5f, 0, 0}).mean.g, 0.0, 1e-6) << "in the shadow of the card";
  expectMean(seen({0.5f, 0.5f, 4}, {0.5f, 0, 0}), kZenithRadiance, 1e-4);
  scene.materials[1].base_color = glm::vec4(0.5f, 0.5f, 0.5f, 1);
  expectMean(seen({-0.5f, 4, 0}, {-0.5f, 0, 0}), 0.5 * kZenithRadiance, 1e-4);
  expectMean(seen({0.5f, 4, 0}, {0.5f, 0, 0}), kZenithRadiance, 1e-4);
}

TEST(Material, OfBlendedSurfacesCoversTheEyeOnly) {
  gltf::Material glass = testing::matte();
  glass.alpha_mode = gltf::AlphaMode::Blend;
  glass.base_color = glm::vec4(0.2f, 0.2f, 0.2f, 0.25f);
  const Scene scene = floorAndCard(glass);
  const auto seen = [&](glm::vec3 eye, glm::vec3 target) {
    return measured(scene, eye, target, {kZenith}, samples(16, 0));
  };
  expectMean(seen({0, 4, 0}, {0, 0, 0}), (0.25 * 0.2 + 0.75) * kZenithRadiance, 1e-4);
  expectMean(seen({0, 0.5f, 4}, {0, 0, 0}), kZenithRadiance, 1e-4);  // no shadow
  // Over the sky, coverage is the alpha, and the sky is visible through the card.
  Scene alone = sceneOf({testing::grid({0, 1, 0}, 2.0f, 1)});
  testing::paint(alone, 0, glass);
  const Measured sky = measured(alone, {0, 4, 0}, {0, 1, 0}, {testing::uniform(1.0f)}, samples(4, 0));
  EXPECT_NEAR(sky.alpha, 0.25, 1e-6);
  expectMean(sky, 0.25 * 0.2 + 0.75);
}

TEST(Material, OfUnlitSurfacesShowsItsColourBlocksAndGivesNothing) {
  gltf::Material unlit, black = testing::matte(0.0f);
  unlit.unlit = true;
  unlit.base_color = glm::vec4(0.3f, 0.4f, 0.5f, 1);
  unlit.emissive = glm::vec3(7.0f);
  unlit.double_sided = black.double_sided = true;
  const std::vector<spec::Light> light = {testing::uniform(2.0f)};
  const Measured card = measured(floorAndCard(unlit), {0, 4, 0}, {0, 1, 0}, light, samples(4));
  EXPECT_NEAR(card.mean.r, 0.3, 1e-6);
  EXPECT_NEAR(card.mean.b, 0.5, 1e-6);
  const Measured floor = measured(floorAndCard(unlit), {0, 0.5f, 4}, {0, 0, 0}, light, samples(16));
  const Measured floor_black = measured(floorAndCard(black), {0, 0.5f, 4}, {0, 0, 0}, light, samples(16));
  EXPECT_EQ(floor.mean, floor_black.mean);
  EXPECT_LT(floor.mean.g, 1.9);
}

TEST(Material, OfOneSideIsCulledForTheEyeAndBlackForTheLight) {
  gltf::Material white = testing::matte();
  Scene one = floorAndCard(white);
  white.double_sided = true;
  const Scene two = floorAndCard(white);
  // From below, looking up at the card: its back is not there, the sky is; two-sided, the card is.
  const std::vector<spec::Light> light = {testing::uniform(1.0f)};
  EXPECT_EQ(measured(one, {0, 0.1f, 0}, {0, 1, 0}, light, samples(1)).alpha, 0.0);
  EXPECT_EQ(measured(two, {0, 0.1f, 0}, {0, 1, 0}, light, samples(1)).alpha, 1.0);
  // On the floor under it: the back blocks the sky; two-sided, in a white furnace, it is as bright as the
  // sky.
  const Measured dark = measured(one, {0, 0.5f, 4}, {0, 0, 0}, light, samples(64));
  const Measured bright = measured(two, {0, 0.5f, 4}, {0, 0, 0}, light, samples(64));
  expectMean(bright, 1.0, 1e-3);  // some paths go to and fro until roulette ends them
  // The form factor of the card over the point is 4/pi * (a / sqrt(1 + a²)) atan(a / sqrt(1 + a²)) at a = 1.
  const double a = std::sqrt(0.5);
  expectMean(dark, 1.0 - 4.0 / double{kPi} * a * std::atan(a));
}

TEST(Material, OfTexturesIsLinearAndMultiplies) {
  Scene scene = sceneOf({testing::grid({0, 0, 0}, 2.0f, 1)});
  scene.materials[0].base_color = glm::vec4(1.0f, 0.5f, 1.0f, 1.0f);
  scene.materials[0].base_color_texture = stripes(scene, {128, 128, 128, 255, 255, 255, 255, 255});
  auto& mesh = scene.meshes[0].primitives[0].mesh;
  mesh.colors.assign(mesh.positions.size(), glm::vec4(0.5f, 1, 1, 1));
  const auto seen = [&](float x) {
    return measured(scene, {x, 2, 0.1f}, {x, 0, 0}, {testing::uniform(1.0f)}, samples(4, 0)).mean;
  };
  EXPECT_NEAR(seen(-0.5f).r, 0.5 * 0.21586, 1e-4);  // 128 in sRGB
  EXPECT_NEAR(seen(-0.5f).g, 0.5 * 0.21586, 1e-4);
  EXPECT_NEAR(seen(0.5f).g, 0.5, 1e-5);
}

TEST(Material, OfEmissiveTexturesShinesWhereTheyAreBright) {
  // The right half of a lamp over a floor, both as it looks and by what it gives: points that mirror each
  // other about the lamp's middle get what the whole lamp gives, together.
  Scene scene =
      sceneOf({testing::grid({0, 0, 0}, 8.0f, 1), testing::flipped(testing::grid({0, 1, 0}, 2.0f, 1))});
  testing::paint(scene, 1, testing::lamp(10.0f));
  const auto at = [](const Scene& lit, float x) {
    return measured(lit, {x, 0.9f, 3}, {x, 0, 0}, {}, samples(256, 0));
  };
  const Measured whole = at(scene, 0.6f);
  scene.materials[1].emissive_texture = stripes(scene, {0, 0, 0, 255, 255, 255, 255, 255});
  const Measured near = at(scene, 0.6f), far = at(scene, -0.6f);
  EXPECT_GT(near.mean.g, 1.3 * far.mean.g);
  EXPECT_NEAR(near.mean.g + far.mean.g, whole.mean.g, 4.0 * (near.error.g + far.error.g + whole.error.g));
  EXPECT_EQ(measured(scene, {0.5f, 0.2f, 0}, {0.5f, 1, 0.1f}, {}, samples(1, 0)).mean.g, 10.0);
  EXPECT_EQ(measured(scene, {-0.5f, 0.2f, 0}, {-0.5f, 1, 0.1f}, {}, samples(1, 0)).mean.g, 0.0);
}

TEST(Material, OfNormalMapsTurnsTheCosineOnly) {
  // A texel's +X leans along u (+x here), its +Y against v (-z here), with or without tangents in the file.
  const std::uint8_t lean = 128 + 64;
  for (const bool tangents : {false, true})
    for (const int axis : {0, 1}) {
      Scene scene = sceneOf({testing::grid({0, 0, 0}, 2.0f, 1)});
      scene.materials[0].normal_texture =
          axis == 0 ? stripes(scene, {lean, 128, 255, 255}) : stripes(scene, {128, lean, 255, 255});
      auto& mesh = scene.meshes[0].primitives[0].mesh;
      if (tangents) mesh.tangents.assign(mesh.positions.size(), glm::vec4(1, 0, 0, 1));
      const float share = 2.0f * static_cast<float>(lean) / 255.0f - 1.0f,
                  rest = 2.0f * 128.0f / 255.0f - 1.0f;
      const glm::vec3 normal =
          glm::normalize(axis == 0 ? glm::vec3(share, 1, -rest) : glm::vec3(rest, 1, -share));
      for (const float azimuth : {90.0f, 180.0f, 0.0f}) {  // +X, -Z, +Z
        const spec::SunLight sun{
            .azimuth_deg = azimuth, .elevation_deg = 45, .angle_deg = 1, .radiance = glm::vec3(1000)};
        const float cosine =
            std::max(0.0f, glm::dot(normal, spec::directionFromAzimuthElevation(azimuth, 45)));
        expectMean(measured(scene, {0.2f, 2, 0.1f}, {0.2f, 0, 0}, {sun}, samples(16, 0)),
                   cosine * kZenithRadiance, 1e-3);
      }
    }
}

}  // namespace
}  // namespace lambent::baker::reference
