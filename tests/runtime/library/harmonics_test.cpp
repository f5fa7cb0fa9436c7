// Tests light in harmonics through the library's headers, against closed forms.
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "lambent/sh.hpp"
#include "lambent/version.hpp"

namespace lambent {
namespace {

TEST(LibraryHarmonics, GiveUniformLightAsItIs) {
  const std::vector<Vec3> white(256 * 128, Vec3{1.0f, 2.0f, 3.0f});
  const Expected<LightVector> light = projectEquirect(white, 256, 128, 5);
  ASSERT_TRUE(light);
  ASSERT_EQ(light->coefficients.size(), 25u);
  const Vec3 seen = light->radiance({0.0f, 0.6f, 0.8f}),
             received = light->irradianceOverPi({0.0f, 1.0f, 0.0f});
  EXPECT_NEAR(seen.y, 2.0f, 1e-3f);
  EXPECT_NEAR(received.x, 1.0f, 1e-3f);
  EXPECT_NEAR(received.z, 3.0f, 1e-3f);
}

TEST(LibraryHarmonics, TurnLightIntoAnotherFrame) {
  const Expected<LightVector> sun = lightFrom({"sun:90,0,20,5,5,5"}, 6);  // it stands on +X
  ASSERT_TRUE(sun);
  // The frame's z axis is the world's x axis.
  const Expected<LightVector> turned = sun->rotated({0, 0, -1, 0, 1, 0, 1, 0, 0});
  ASSERT_TRUE(turned) << turned.failure().line();
  EXPECT_NEAR(turned->radiance({0, 0, 1}).x, sun->radiance({1, 0, 0}).x, 1e-4f);
  EXPECT_NEAR(turned->radiance({-1, 0, 0}).x, sun->radiance({0, 0, 1}).x, 1e-4f);
}

TEST(LibraryHarmonics, WithoutRingingAreNowhereNegative) {
  const Expected<LightVector> sun = lightFrom({"sun:0,90,2,900,900,900"}, 5);
  ASSERT_TRUE(sun);
  float least = 0.0f, least_mended = 0.0f;
  const LightVector mended = sun->withoutRinging();
  for (int i = 0; i <= 180; ++i) {
    const float a = static_cast<float>(i) * std::numbers::pi_v<float> / 180.0f;
    const Vec3 direction{std::sin(a), std::cos(a), 0.0f};
    least = std::min(least, sun->radiance(direction).x);
    least_mended = std::min(least_mended, mended.radiance(direction).x);
  }
  EXPECT_LT(least, -0.1f);
  EXPECT_GT(least_mended, -1e-3f * sun->radiance({0, 1, 0}).x);
}

TEST(LibraryHarmonics, SayWhatIsWrong) {
  EXPECT_EQ(lightFrom({"constant:1,1,1"}, 9).failure().line(), "order: 9 is not in 1..8");
  EXPECT_FALSE(lightFrom({"sphere:0,0,0,1,1"}, 5));
  EXPECT_FALSE(lightFrom({"nowhere.hdr"}, 5));
  EXPECT_FALSE(projectEquirect({}, 4, 2, 5));
  EXPECT_FALSE(LightVector{.order = 2}.rotated({2, 0, 0, 0, 1, 0, 0, 0, 1}));
  std::vector<float> short_of_room(8);
  EXPECT_FALSE(evaluateHarmonics(3, {0, 0, 1}, short_of_room));
}

TEST(LibraryVersion, IsThatOfThePrograms) {
  EXPECT_STREQ(version(), LAMBENT_VERSION);
}

}  // namespace
}  // namespace lambent
