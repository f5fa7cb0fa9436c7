#include "runtime/lighting/capture.hpp"

#include <array>

#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"
#include "tests/runtime/lighting/capture_fixture.hpp"
#include "tests/runtime/lighting/capture_scenes.hpp"

namespace lambent::lighting {
namespace {

using testing::cubeProxy;
using testing::discBody;
using testing::discProxy;
using testing::facing;
using testing::proxyOf;
using testing::squaredError;
using testing::squareProxy;

constexpr float kDegree = std::numbers::pi_v<float> / 180.0f;

double energy(const sh::LightVector& light) {
  double sum = 0;
  for (const glm::vec3& c : light.c) sum += glm::dot(glm::dvec3(c), glm::dvec3(c));
  return sum;
}

}  // namespace

TEST_F(CaptureTest, NothingInSightLeavesTheExactSkyWithoutSunsAndCostsTheGpuNothing) {
  const Environment environment = *Environment::create(
      {spec::ConstantLight{.radiance = {1, 2, 3}}, spec::SunLight{.azimuth_deg = 20, .elevation_deg = 30}});
  const auto light = captured(environment, {.points = {{.queries = {{.direction = {0, 1, 0}}}}, {}}});
  ASSERT_EQ(light.size(), 2u);
  EXPECT_LT(squaredError(light[0].light, sh::constantLight(6, {1, 2, 3})), 1e-12);
  EXPECT_EQ(light[0].sky_visible, glm::vec3(1));
  EXPECT_EQ(light[0].visible, std::vector<float>{1.0f});
  EXPECT_TRUE(light[1].visible.empty());
  EXPECT_EQ(counters.draws, 0u);
}

TEST_F(CaptureTest, ABlackDiscTakesItsCapOutOfTheSky) {
  // A disc gives what a sphere of the same angular radius does: literature 7.3.
  for (const double degrees : {5.0, 20.0, 40.0}) {
    const glm::vec3 from(3, -2, 5), direction = glm::normalize(glm::vec3(1, 2, -0.5f));
    const double radius = degrees * std::numbers::pi / 180;
    const auto light = captured(uniformSky(2), {.proxies = {discProxy()},
                                                .bodies = {discBody(0, from, direction, radius, 10)},
                                                .points = {{.position_ws = from}}});
    sh::LightVector cap = sh::constantLight(6, glm::vec3(2));
    for (std::size_t i = 0; i < 36; ++i) cap.c[i] -= light[0].light.c[i];
    EXPECT_LT(squaredError(cap, sh::discLight(6, direction, radius, glm::vec3(2))), 0.002) << degrees;
    const double hidden = (1 - std::cos(radius)) / 2;
    EXPECT_NEAR(light[0].sky_visible.g, 1 - hidden, 0.01 * hidden)
        << degrees << ": a radius of 5 is 15 subsamples";
  }
}

TEST_F(CaptureTest, AClosedRoomIsDarkUnderABrightSky) {
  const auto light =
      captured(uniformSky(1e8f),
               {.proxies = {cubeProxy(true)},
                .bodies = {{0, glm::scale(glm::mat4(1), glm::vec3(3))}},
                .points = {{.position_ws = {0.3f, -1, 0.5f}, .queries = {{.direction = {0, 0, 1}}}}}});
  EXPECT_EQ(energy(light[0].light), 0.0);
  EXPECT_EQ(light[0].sky_visible, glm::vec3(0));
  EXPECT_EQ(light[0].visible[0], 0.0f);
}

TEST_F(CaptureTest, InAFurnaceNothingIsSeen) {
  // Walls that shine like the sky: no coefficient but the first, whatever hides what.
  const std::vector<glm::vec4> shining(12, glm::vec4(1));
  const auto light =
      captured(uniformSky(1), {.proxies = {cubeProxy()},
                               .radiance = shining,
                               .bodies = {{0, glm::translate(glm::mat4(1), glm::vec3(2.5f, 1, -0.5f))},
                                          {0, glm::translate(glm::mat4(1), glm::vec3(0, -3, 1))}},
                               .points = {{}}});
  EXPECT_LT(squaredError(light[0].light, sh::constantLight(6, glm::vec3(1))), 1e-11);
}

TEST_F(CaptureTest, ALightIsHiddenByWhatStandsBeforeItOnly) {
  const glm::vec3 z(0, 0, 1);
  const auto light =
      captured(uniformSky(1),
               {.proxies = {squareProxy()},
                .bodies = {{0, facing({0, 0, 4}, {}, 1)}},
                .points = {{.queries = {{.direction = z, .distance_m = 3},
                                        {.direction = z, .distance_m = 4},  // in the body's own surface
                                        {.direction = z, .distance_m = 5},
                                        {.direction = z},
                                        {.direction = -z},
                                        {.direction = z, .angular_radius_rad = 0.1f, .distance_m = 5}}}}});
  EXPECT_EQ(light[0].visible, (std::vector<float>{1, 1, 0, 0, 1, 0}));
}

TEST_F(CaptureTest, ALightAllAroundIsHalfHiddenByAWallAtThePoint) {
  const LightQuery around{.direction = {0, 1, 0}, .angular_radius_rad = 170 * kDegree};
  const auto light = captured(uniformSky(0), {.proxies = {squareProxy()},
                                              .bodies = {{0, facing({0, -0.001f, 0}, {}, 100)}},
                                              .points = {{.queries = {around}}}});
  EXPECT_NEAR(light[0].visible[0], 1 / (1 + std::cos(10 * kDegree)), 1.0f / 32);
  EXPECT_TRUE(allFinite(light[0]));
}

TEST_F(CaptureTest, APointInsideABodySeesItsBlackInside) {
  for (const float offset : {0.0f, 0.5f, 0.999f, 0.99999f}) {
    // At a distance from its face of a hundred-thousandth of the body's size, rasterizers clip differently:
    // on real devices up to 0.3 % of the sky leaks in.
    const bool at_the_face = offset > 0.9999f;
    const auto light = captured(uniformSky(1), {.proxies = {cubeProxy()},
                                                .radiance = std::vector(12, glm::vec4(1)),
                                                .bodies = {{}},
                                                .points = {{.position_ws = {offset, 0, 0}}}});
    EXPECT_LT(light[0].sky_visible.r, at_the_face ? 5e-3f : 1e-3f) << offset;
    EXPECT_LT(energy(light[0].light), at_the_face ? 5e-3 : 1e-5) << offset;
  }
  // Exactly in a face there is no right answer, but a finite one.
  const auto light =
      captured(uniformSky(1), {.proxies = {cubeProxy()},
                               .bodies = {{}},
                               .points = {{.position_ws = {1, 0, 0}}, {.position_ws = {1, 1, 1}}}});
  EXPECT_TRUE(allFinite(light[0]) && allFinite(light[1]));
}

TEST_F(CaptureTest, AFloorCloseUnderThePointHidesHalfOfTheSky) {
  // The heights go down to a hundred-thousandth of the body's size, where clipping is no longer exact.
  for (const float height : {1e-2f, 1.0f}) {
    const auto light = captured(uniformSky(1), {.proxies = {squareProxy()},
                                                .bodies = {{0, facing({0, 0, 0}, {0, 1, 0}, 1000)}},
                                                .points = {{.position_ws = {0.3f, height, 0.1f}}}});
    EXPECT_NEAR(light[0].sky_visible.r, 0.5f, 0.005f) << height;
  }
}

TEST_F(CaptureTest, RadianceOf1e8IsLinear) {
  Scene scene{.proxies = {squareProxy()},
              .radiance = std::vector(2, glm::vec4(1)),
              .bodies = {{0, facing({1, 2, 0}, {}, 1)}},
              .points = {{}}};
  const auto one = captured(uniformSky(1), scene);
  for (glm::vec4& radiance : scene.radiance) radiance *= 1e8f;
  const auto bright = captured(uniformSky(1e8f), scene);
  EXPECT_LT(squaredError(bright[0].light * 1e-8f, one[0].light), 1e-11);
}

TEST_F(CaptureTest, ARadianceThatIsNotFiniteIsBlack) {
  const float infinity = std::numeric_limits<float>::infinity();
  const auto light = captured(uniformSky(1), {.proxies = {squareProxy()},
                                              .radiance = {glm::vec4(infinity, NAN, 1, 0), glm::vec4(1)},
                                              .bodies = {{0, facing({1, 2, 0}, {}, 1)}},
                                              .points = {{}}});
  EXPECT_TRUE(allFinite(light[0]));
  EXPECT_GT(light[0].light.c[0].b, light[0].light.c[0].r);
}

TEST_F(CaptureTest, BodiesWithoutSizeOrSenseDrawNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  bundle::CaptureProxy empty, no_levels = squareProxy(), bad_corner = squareProxy();
  no_levels.levels.clear();
  bad_corner.positions[1] = glm::vec3(nan);
  bad_corner.positions[3] = glm::vec3(nan);
  const glm::mat4 near = glm::translate(glm::mat4(1), glm::vec3(0, 2, 0));
  Scene scene{
      .proxies = {squareProxy(), proxyOf({{0, 2, 0}}, {{0, 0, 0}}),
                  proxyOf({{0, 2, 0}, {0, 3, 0}}, {{0, 1, 0}}), empty, no_levels, bad_corner},
      .bodies = {{0, glm::mat4(0)},
                 {0, glm::mat4(nan)},
                 {1},
                 {2},
                 {3},
                 {4, near},
                 {5, near},
                 {77, near},
                 {0, glm::translate(glm::mat4(1), glm::vec3(std::numeric_limits<float>::infinity()))}},
      .points = {{},
                 {.position_ws = glm::vec3(nan),
                  .queries = {{.direction = glm::vec3(nan)}, {.direction = glm::vec3(0)}}},
                 {.position_ws = {0, 2, 0}}}};
  const auto light = captured(uniformSky(1), scene);
  for (const CapturedLight& l : light)
    EXPECT_LT(squaredError(l.light, sh::constantLight(6, glm::vec3(1))), 1e-10);
}

TEST_F(CaptureTest, SmallBodiesAreLeftOutUnlessTheyAreBright) {
  const auto capture = Capture::create({}, uniformSky(1));
  ASSERT_TRUE(capture);
  const CaptureOptions options;
  const capture::ProxyBounds bounds = capture::ProxyBounds::of(discProxy());
  // The disc is a quarter of a texel: 4 pi / (6 * 16 * 16) / 4 = 2.05e-3 sr, a radius of 1.46 degrees.
  const auto seen = [&](double degrees, float brightness) {
    CaptureBody body = discBody(0, {}, {0, 1, 0}, degrees * std::numbers::pi / 180, 10);
    body.brightness = brightness;
    return capture::sees(options, glm::vec3(0.0f), capture::BodySphere::of(body, bounds));
  };
  EXPECT_FALSE(seen(1.4, 1));
  EXPECT_TRUE(seen(1.5, 1));
  EXPECT_TRUE(seen(0.15, 100));
  EXPECT_FALSE(seen(0.14, 100));
  EXPECT_FALSE(seen(1.4, 0)) << "dark bodies hide no more than others";
  EXPECT_TRUE(seen(0.01, std::numeric_limits<float>::infinity()));
}

TEST_F(CaptureTest, AFadedSkyIsHiddenByItsShare) {
  Environment environment =
      *Environment::create({spec::ConstantLight{{1, 0, 0}}}, {spec::ConstantLight{{0, 2, 0}}});
  environment.setFade(0.25f);
  environment.setIntensity(2.0f);
  const auto light = captured(
      environment, {.proxies = {squareProxy()}, .bodies = {{0, facing({0, 2, 0}, {}, 2)}}, .points = {{}}});
  sh::LightVector open = sh::constantLight(6, {1.5f, 1, 0});
  EXPECT_NEAR(light[0].sky_visible.r, 5.0f / 6, 1e-4f);
  EXPECT_NEAR(light[0].light.c[0].r, open.c[0].r * 5 / 6, 1e-3f);
  EXPECT_NEAR(light[0].light.c[0].g, open.c[0].g * 5 / 6, 1e-3f);
  EXPECT_EQ(light[0].light.c[0].b, 0.0f);
}

}  // namespace lambent::lighting
