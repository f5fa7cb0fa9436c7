#include "runtime/lighting/environment.hpp"

#include <chrono>
#include <filesystem>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"

namespace lambent::lighting {

TEST(Environment, TurnsAsASunOfTheTurnedAzimuth) {
  const auto sun = [](float azimuth) {
    return *Environment::create(
        {spec::SunLight{.azimuth_deg = azimuth, .elevation_deg = 25, .angle_deg = 5}});
  };
  Environment turned = sun(20);
  const std::uint64_t version = turned.version();
  turned.setTurn(0.0f);
  EXPECT_EQ(turned.version(), version) << "no turn, nothing new";
  turned.setTurn(70.0f);
  EXPECT_NE(turned.version(), version);
  const Environment placed = sun(90);
  for (std::size_t i = 0; i < 64; ++i)
    EXPECT_LT(glm::distance(turned.light().c[i], placed.light().c[i]), 1e-5f) << "coefficient " << i;
  // After a thousand turns there is no trace of them.
  for (int i = 0; i < 1000; ++i) turned.setTurn(static_cast<float>(i) * 0.37f);
  turned.setTurn(0.0f);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(turned.light().c[i], sun(20).light().c[i]);
}

// Makes two sets with one sun each, so that they can be distinguished.
Result<Environment> twoSets() {
  return Environment::create(
      {spec::ConstantLight{.radiance = {1, 2, 3}},
       spec::SunLight{.azimuth_deg = 20, .elevation_deg = 25, .angle_deg = 5, .radiance = {4, 4, 4}}},
      {spec::ConstantLight{.radiance = {0, 0, 8}},
       spec::SunLight{.azimuth_deg = -50, .elevation_deg = 60, .angle_deg = 9, .radiance = {2, 0, 1}}});
}

TEST(Environment, MixesTwoSetsTurnedTogether) {
  auto environment = twoSets();
  ASSERT_TRUE(environment);
  EXPECT_EQ(
      environment->light().c[0],
      Environment::create(
          {spec::ConstantLight{.radiance = {1, 2, 3}},
           spec::SunLight{.azimuth_deg = 20, .elevation_deg = 25, .angle_deg = 5, .radiance = {4, 4, 4}}})
          ->light()
          .c[0])
      << "the first set alone, where nothing is faded";
  environment->setTurn(30.0f);
  environment->setFade(0.25f);
  environment->setIntensity(2.0f);
  // The light is 1.5 of the first set and 0.5 of the second, whose suns are 30 degrees further round.
  constexpr double kDegree = 3.14159265358979 / 180.0;
  const sh::LightVector sky = sh::constantLight(8, {1.5f, 3.0f, 8.5f});
  const glm::vec3 first = spec::directionFromAzimuthElevation(50, 25),
                  second = spec::directionFromAzimuthElevation(-20, 60);
  const sh::LightVector whole = sky + sh::discLight(8, first, 5 * kDegree, glm::vec3(6.0f)) +
                                sh::discLight(8, second, 9 * kDegree, {1, 0, 0.5f});
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_LT(glm::distance(environment->light().c[i], whole.c[i]), 2e-5f) << "coefficient " << i;
    EXPECT_LT(glm::distance(environment->skyLight().c[i], sky.c[i]), 2e-5f) << "coefficient " << i;
  }
  ASSERT_EQ(environment->discs().size(), 2u);
  EXPECT_LT(glm::distance(environment->discs()[0].direction, first), 1e-6f);
  EXPECT_LT(glm::distance(environment->discs()[1].direction, second), 1e-6f);
  EXPECT_EQ(environment->discs()[0].radiance, glm::vec3(6.0f));
  EXPECT_EQ(environment->discs()[1].radiance, glm::vec3(1.0f, 0.0f, 0.5f));
  environment->setFade(1.0f);
  EXPECT_EQ(environment->discs()[0].radiance, glm::vec3(0.0f)) << "dark, but still the first";
  EXPECT_EQ(environment->skyLight().c[0].r, 0.0f);
}

TEST(Environment, HasANewVersionOnlyWhereSomethingChanged) {
  auto environment = twoSets();
  ASSERT_TRUE(environment);
  const std::uint64_t version = environment->version();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (const float same : {0.0f, -1.0f, kNaN}) environment->setFade(same);
  for (const float same : {1.0f, kNaN}) environment->setIntensity(same);
  for (const float same : {0.0f, kNaN}) environment->setTurn(same);
  EXPECT_EQ(environment->version(), version);
  environment->setFade(7.0f);
  EXPECT_EQ(environment->fade(), 1.0f);
  const std::uint64_t faded = environment->version();
  EXPECT_NE(faded, version);
  environment->setIntensity(-3.0f);
  EXPECT_EQ(environment->intensity(), 0.0f);
  EXPECT_NE(environment->version(), faded);
  for (const glm::vec3& c : environment->light().c) EXPECT_EQ(c, glm::vec3(0.0f));
}

// Makes an image of one radiance.
void writeEnvironmentMap(const std::filesystem::path& file, float radiance) {
  const spec::RgbaImage image{
      .width = 8, .height = 4, .texels = std::vector<glm::vec4>(32, glm::vec4(radiance))};
  ASSERT_TRUE(spec::writeExr(file, image));
}

TEST(Environment, ReadsAProbeAgainOnlyWhenItsFileChanged) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "lambent-environment-again.exr";
  writeEnvironmentMap(file, 1.0f);
  const auto written = std::filesystem::last_write_time(file);
  const auto withSun = [&](float azimuth) {
    return std::vector<spec::Light>{
        spec::EnvironmentMapLight{.file = file, .layout = {}},
        spec::SunLight{.azimuth_deg = azimuth, .elevation_deg = 25, .angle_deg = 5}};
  };
  auto environment = Environment::create(withSun(20), withSun(-20));
  ASSERT_TRUE(environment) << environment.error().line();
  environment->setFade(0.25f);
  environment->setTurn(30.0f);
  // The file's contents are now unreadable, but its size and time are unchanged: setLights() uses what it has
  // loaded.
  const auto bytes = std::filesystem::file_size(file);
  std::filesystem::resize_file(file, 0);
  std::filesystem::resize_file(file, bytes);
  std::filesystem::last_write_time(file, written);
  ASSERT_FALSE(Environment::create(withSun(21)));
  ASSERT_TRUE(environment->setLights(withSun(21), withSun(-21)));
  EXPECT_EQ(environment->fade(), 0.25f);
  EXPECT_EQ(environment->turnDegrees(), 30.0f);

  // The light equals that of an environment created with these lights.
  writeEnvironmentMap(file, 1.0f);
  auto made = Environment::create(withSun(21), withSun(-21));
  ASSERT_TRUE(made);
  EXPECT_EQ(environment->lightsVersion(), made->lightsVersion());
  made->setFade(0.25f);
  made->setTurn(30.0f);
  EXPECT_EQ(environment->version(), made->version());
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(environment->light().c[i], made->light().c[i]);

  // Another picture under its name is read; what cannot be read changes nothing.
  writeEnvironmentMap(file, 2.0f);
  std::filesystem::last_write_time(file, written + std::chrono::seconds(5));
  ASSERT_TRUE(environment->setLights(withSun(21), withSun(-21)));
  EXPECT_NE(environment->lightsVersion(), made->lightsVersion());
  const std::uint64_t version = environment->version();
  std::filesystem::remove(file);
  EXPECT_FALSE(environment->setLights(withSun(22)));
  EXPECT_EQ(environment->version(), version);
  EXPECT_EQ(environment->discs().size(), 2u);
}

}  // namespace lambent::lighting
