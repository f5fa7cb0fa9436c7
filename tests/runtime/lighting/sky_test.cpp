// Checks that the drawn sky is the radiance of the environment as rotated, faded and scaled.
#include "runtime/lighting/sky.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/lighting/prefiltered_environment.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/spec/image.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::lighting {

class SkyTest : public testing::GpuTest {
 protected:
  // Returns what the middle pixel of a narrow picture along dir shows.
  static glm::vec3 seen(const Sky& sky, const Environment& environment, glm::vec3 dir) {
    constexpr std::uint32_t kSide = 5;
    const gpu::Texture color("color", {.format = GL_RGBA32F, .width = kSide, .height = kSide});
    const gpu::Framebuffer target("target", color, nullptr);
    glBindFramebuffer(GL_FRAMEBUFFER, target.id());
    glViewport(0, 0, kSide, kSide);
    glClear(GL_COLOR_BUFFER_BIT);
    const glm::vec3 up = std::abs(dir.y) > 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    gpu::Counters counters;
    sky.draw(environment, glm::lookAt(glm::vec3(0.0f), dir, up), glm::perspective(0.05f, 1.0f, 0.1f, 10.0f),
             kSide, counters);
    std::vector<glm::vec4> texels(kSide * kSide);
    glGetTextureImage(color.id(), 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(texels.size() * 16),
                      texels.data());
    return glm::vec3(texels[kSide * kSide / 2]);
  }
};

TEST_F(SkyTest, ShowsTheMixOfBothSets) {
  auto environment = Environment::create(
      {spec::ConstantLight{.radiance = {1, 2, 3}},
       spec::SunLight{.azimuth_deg = 20, .elevation_deg = 0, .angle_deg = 8, .radiance = {4, 4, 4}}},
      {spec::ConstantLight{.radiance = {0, 0, 8}},
       spec::SunLight{.azimuth_deg = 90, .elevation_deg = 60, .angle_deg = 9, .radiance = {2, 0, 1}}});
  ASSERT_TRUE(environment);
  const auto sky = Sky::create(*environment);
  ASSERT_TRUE(sky) << sky.error().line();
  environment->setTurn(-30.0f);
  environment->setFade(0.75f);
  environment->setIntensity(2.0f);
  const auto expectSeen = [&](float azimuth, float elevation, glm::vec3 expected) {
    const glm::vec3 found = seen(*sky, *environment, spec::directionFromAzimuthElevation(azimuth, elevation));
    EXPECT_LT(glm::distance(found, expected), 1e-4f)
        << azimuth << ", " << elevation << ": " << found.r << " " << found.g << " " << found.b;
  };
  const glm::vec3 between(0.5f, 1.0f, 13.5f);  // 0.5 of the first set, 1.5 of the second
  expectSeen(120, -10, between);
  expectSeen(-10, 0, between + glm::vec3(2.0f));
  expectSeen(60, 60, between + glm::vec3(3.0f, 0.0f, 1.5f));
}

// An infinite texel of half floats would make its neighbours NaN, and so would it times a fade of 0.
TEST_F(SkyTest, ShowsRadianceBeyondHalfFloatsAsTheLargest) {
  auto environment = Environment::create({spec::ConstantLight{.radiance = {1e6f, 1.0f, 1e9f}}},
                                         {spec::ConstantLight{.radiance = {0, 0, 8}}});
  ASSERT_TRUE(environment);
  const auto sky = Sky::create(*environment);
  ASSERT_TRUE(sky) << sky.error().line();
  const glm::vec3 brightest = seen(*sky, *environment, {0, 0, 1});
  EXPECT_NEAR(brightest.r, 65504.0f, 1.0f);
  EXPECT_NEAR(brightest.g, 1.0f, 1e-3f);
  EXPECT_NEAR(brightest.b, 65504.0f, 1.0f);
  environment->setFade(1.0f);
  EXPECT_LT(glm::distance(seen(*sky, *environment, {0, 0, 1}), glm::vec3(0, 0, 8)), 1e-3f);
}

// A key light that was moved is visible in its new place, and no longer in the old.
TEST_F(SkyTest, ShowsAMovedKeyLightAsADiscInPlaceOfItsTexels) {
  const glm::vec3 sun = spec::directionFromAzimuthElevation(40, 50);
  spec::RgbImage image{.width = 256, .height = 128, .texels = {}};
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 256; ++x) {
      const glm::dvec3 dir = sh::texelDirection(sh::ImageLayout::LatLong, 256, 128, x, y);
      image.texels.push_back(glm::distance(glm::vec3(dir), sun) < 0.05f ? glm::vec3(1000.0f)
                                                                        : glm::vec3(1.0f));
    }
  const auto file = std::filesystem::path(::testing::TempDir()) / (std::to_string(getpid()) + "-sky.hdr");
  ASSERT_TRUE(spec::writeHdr(file, image));
  auto environment = Environment::create({spec::EnvironmentMapLight{file, std::nullopt}});
  std::filesystem::remove(file);
  ASSERT_TRUE(environment);
  environment->setMostKeys(16);
  ASSERT_EQ(environment->foundKeys().size(), 1u);
  auto sky = Sky::create(*environment);
  ASSERT_TRUE(sky) << sky.error().line();
  const glm::vec3 to = spec::directionFromAzimuthElevation(-60, 10);
  EXPECT_NEAR(seen(*sky, *environment, sun).r, 1000.0f, 20.0f);
  EXPECT_NEAR(seen(*sky, *environment, to).r, 1.0f, 0.02f);
  const std::uint64_t version = PrefilteredEnvironment::sourceVersion(*environment);
  environment->setKeyEdits({{.found = sun, .towards = to, .factor = {0.5f, 0.25f, 0.0f}}});
  const Environment::FoundKey key = environment->foundKeys()[0];
  ASSERT_TRUE(key.edit);
  EXPECT_TRUE(sky->update(*environment));
  EXPECT_FALSE(sky->update(*environment));
  const glm::vec3 moved = seen(*sky, *environment, to);
  EXPECT_NEAR(moved.r, key.now.radiance.r + 1.0f, 0.02f * key.now.radiance.r);
  EXPECT_NEAR(moved.g, key.now.radiance.g + 1.0f, 0.02f * key.now.radiance.g);
  EXPECT_NEAR(moved.b, 1.0f, 0.02f) << "none of this channel is left";
  EXPECT_LT(seen(*sky, *environment, sun).r, 300.0f) << "what the rest keeps";
  EXPECT_EQ(PrefilteredEnvironment::sourceVersion(*environment), version) << "mirrors show the disc apart";
  environment->setKeyEdits({});
  EXPECT_TRUE(sky->update(*environment));
  EXPECT_NEAR(seen(*sky, *environment, sun).r, 1000.0f, 20.0f);
}

}  // namespace lambent::lighting
