#include "runtime/lighting/environment.hpp"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent::lighting {

TEST(Environment, AddsItsLights) {
  const auto environment = Environment::create(
      {spec::ConstantLight{.radiance = {1, 2, 3}}, spec::ConstantLight{.radiance = {0.5f, 0, 0}},
       spec::SunLight{.azimuth_deg = 90, .elevation_deg = 0, .angle_deg = 10, .radiance = {1, 1, 1}}});
  ASSERT_TRUE(environment);
  sh::LightVector expected = sh::constantLight(8, {1.5f, 2, 3});
  expected += sh::discLight(8, {1, 0, 0}, 10.0 * 3.14159265358979 / 180.0, glm::vec3(1.0f));
  for (std::size_t i = 0; i < 64; ++i)
    EXPECT_LT(glm::distance(environment->light().c[i], expected.c[i]), 1e-5f) << "coefficient " << i;
  EXPECT_EQ(environment->constant(), glm::vec3(1.5f, 2, 3));
  ASSERT_EQ(environment->discs().size(), 1u);
}

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
  EXPECT_GT(turned.version(), version);
  const Environment placed = sun(90);
  for (std::size_t i = 0; i < 64; ++i)
    EXPECT_LT(glm::distance(turned.light().c[i], placed.light().c[i]), 1e-5f) << "coefficient " << i;
  // A thousand turns leave no trace.
  for (int i = 0; i < 1000; ++i) turned.setTurn(static_cast<float>(i) * 0.37f);
  turned.setTurn(0.0f);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(turned.light().c[i], sun(20).light().c[i]);
}

TEST(Environment, ProjectsAProbeToItsMeanRadiance) {
  const auto file = testing::sharedFile("probes/uffizi_latlong_small.hdr");
  LAMBENT_NEEDS_SHARED(file);
  const auto environment = Environment::create({spec::ProbeLight{.file = file, .layout = {}}});
  ASSERT_TRUE(environment) << environment.error().line();
  // Band 0 is the mean times sqrt(4 pi); the mean luminance of this probe is 0.882, or 0.885
  // for readers that take RGBE mantissas at the middle of their steps.
  const glm::vec3 mean = environment->light().c[0] / 3.5449077f;
  EXPECT_NEAR(glm::dot(mean, glm::vec3(0.2126f, 0.7152f, 0.0722f)), 0.885f, 0.004f);
}

TEST(Environment, NamesAProbeThatIsNotThere) {
  const auto environment = Environment::create({spec::ProbeLight{.file = "nowhere.hdr", .layout = {}}});
  ASSERT_FALSE(environment);
  EXPECT_EQ(environment.error().subject, "nowhere.hdr");
}

}  // namespace lambent::lighting
