// Tests --band-limit: the light equals the runtime's light vector, in closed form where nothing is occluded.
#include <gtest/gtest.h>

#include "reference/exit_kernel.hpp"
#include "reference/sampler.hpp"
#include "runtime/sh/local_light.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "tests/reference/measure.hpp"

namespace lambent::baker::reference {
namespace {

using testing::expectMean;
using testing::kPlace;
using testing::limited;
using testing::measured;
using testing::sceneOf;

// Returns E/pi on a surface with nothing around.
double open(const sh::LightVector& light, glm::vec3 normal) {
  std::array<float, sh::kMaxCoefficients> transfer{};
  sh::unoccludedTransfer(light.order, normal, transfer);
  double sum = 0.0;
  for (std::size_t i = 0; i < light.coefficients().size(); ++i)
    sum += double{transfer[i]} * double{light.c[i].g};
  return sum;
}

const glm::vec3 kEye(0.3f, 2, 0.4f);

TEST(BandLimit, OfASunOverAnOpenPlaneIsTheDotProductOfLightAndTransfer) {
  const Scene floor = sceneOf({testing::grid({0, 0, 0}, 4.0f, 1)});
  const spec::SunLight sun{
      .azimuth_deg = 30, .elevation_deg = 20, .angle_deg = 8, .radiance = glm::vec3(100)};
  const auto light = spec::loadDistantLights({sun})->lightVector();
  for (const int order : {2, 3, 5, 8}) {
    const auto seen = measured(floor, kEye, kPlace, {sun}, limited(256, order));
    expectMean(seen, open(light.truncated(order), {0, 1, 0}));
    EXPECT_LT(seen.error.g, 0.01);
  }
}

TEST(BandLimit, IsSignedAndTurnsWithTheLight) {
  // Away from a small sun the expansion of order 3 is negative, and so is the picture.
  const Scene wall = sceneOf({testing::box({0, 0, 0}, {2, 2, 2}, 1)});
  const spec::SunLight sun{
      .azimuth_deg = 0, .elevation_deg = -32, .angle_deg = 8, .radiance = glm::vec3(100)};
  Options options = limited(256, 3);
  options.rotate_light_deg = 90.0f;  // to +X
  const double expected =
      open(spec::turned(spec::loadDistantLights({sun})->lightVector(), 90.0f).truncated(3), {0, 1, 0});
  EXPECT_LT(expected, -0.01);
  expectMean(measured(wall, {0.3f, 3, 0.4f}, {0.1f, 1, 0.2f}, {sun}, options), expected);
}

TEST(BandLimit, OfTheKernelCutsTheCosineAtTheFirstHit) {
  // Nothing occludes an open plane or its mirrored directions, so light of few bands arrives completely, and
  // the answer is exact.
  const Scene floor = sceneOf({testing::grid({0, 0, 0}, 4.0f, 1)});
  const spec::SunLight sun{
      .azimuth_deg = 30, .elevation_deg = 20, .angle_deg = 8, .radiance = glm::vec3(100)};
  const auto light = spec::loadDistantLights({sun})->lightVector();
  for (const int in : {1, 2, 5, 8})
    for (const int out : {1, 2, 5}) {
      EXPECT_NEAR(measured(floor, kEye, kPlace, {testing::uniform(1.0f)}, limited(16, in, out)).mean.g, 1.0,
                  1e-5);
      const auto seen = measured(floor, kEye, kPlace, {sun}, limited(16, in, out));
      EXPECT_NEAR(seen.mean.g, open(light.truncated(std::min(in, out)), {0, 1, 0}), 1e-5) << in << " " << out;
      EXPECT_LT(seen.error.g, 1e-6);
    }
}

// Rays start above the floor by 2^-19 of its 4 m.
TEST(BandLimit, OfASphereOverAnOpenPlaneIsSeenFromThePlace) {
  const Scene floor = sceneOf({testing::grid({0, 0, 0}, 4.0f, 1)});
  const auto expected = [&](int order, glm::dvec3 center, double radius) {
    return open(sh::sphereLight(order, center - glm::dvec3(kPlace), radius, glm::vec3(30)), {0, 1, 0});
  };
  for (const int order : {1, 2, 5, 8})
    for (const glm::vec3 center :
         {glm::vec3(0.5f, 1, 0), glm::vec3(-1, 0.2f, 0), glm::vec3(0.1f, -0.3f, 1.7f)}) {
      const spec::SphereLight sphere{.position_ws = center, .radius_m = 0.3f, .radiance = glm::vec3(30)};
      const auto seen = measured(floor, kEye, kPlace, {sphere}, limited(256, order));
      expectMean(seen, expected(order, glm::dvec3(center), double{sphere.radius_m}), 1e-4);
      EXPECT_LT(seen.error.g, 0.02) << order;
    }
  // Light of two bands is not zero below the plane; light without a band limit is.
  EXPECT_GT(expected(2, {0.1, -0.3, 1.7}, 0.3), 0.05);
}

TEST(BandLimit, OfLightsInHardPlacesStaysFinite) {
  const Scene scene =
      sceneOf({testing::grid({0, 0, 0}, 4.0f, 1), testing::flipped(testing::grid({1, 1, 0}, 1.0f, 1))});
  Options options = limited(16, 8, 8);
  options.bounces = 2;
  for (const glm::vec3 place : {kPlace, kPlace + glm::vec3(0, 1e-6f, 0), glm::vec3(0, 1e30f, 0)})
    for (const float radius : {0.0f, 1e-30f, 1e-6f, 1.0f, 1e18f}) {
      const spec::SphereLight sphere{.position_ws = place, .radius_m = radius, .radiance = glm::vec3(1e8f)};
      const spec::DiscLight disc{.position_ws = place, .radius_m = radius, .radiance = glm::vec3(1e8f)};
      const double seen = measured(scene, kEye, kPlace, {sphere, disc}, options).mean.g;
      EXPECT_TRUE(std::isfinite(seen)) << place.y << " " << radius;
      EXPECT_LT(std::abs(seen), 1e9) << place.y << " " << radius;
    }
}

}  // namespace
}  // namespace lambent::baker::reference
