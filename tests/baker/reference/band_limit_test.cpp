// --band-limit: light as the runtime's light vector has it, in closed form where nothing is in its way.
#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "tests/baker/reference/measure.hpp"

namespace lambent::baker::reference {
namespace {

using testing::expectMean;
using testing::measured;
using testing::samples;
using testing::sceneOf;

Options limited(std::uint32_t spp, int in, std::optional<int> out = {}) {
  Options options = samples(spp, 0);
  options.band_limit = BandLimit{in, out};
  return options;
}

const glm::vec3 kEye(0.3f, 2, 0.4f), kPlace(0.1f, 0, 0.2f);

TEST(BandLimit, LeavesAConstantLightAsItIs) {
  const Scene floor = sceneOf({testing::grid({0, 0, 0}, 4.0f, 1)});
  for (const int order : {1, 2, 5, 8})
    expectMean(measured(floor, kEye, kPlace, {testing::uniform(1.0f)}, limited(16, order)), 1.0);
}

TEST(BandLimit, OfASunOverAnOpenPlaneIsTheDotProductOfLightAndTransfer) {
  const Scene floor = sceneOf({testing::grid({0, 0, 0}, 4.0f, 1)});
  const spec::SunLight sun{
      .azimuth_deg = 30, .elevation_deg = 20, .angle_deg = 8, .radiance = glm::vec3(100)};
  const auto light = spec::loadDistantLights({sun})->lightVector();
  for (const int order : {2, 3, 5, 8}) {
    std::array<float, sh::kMaxCoefficients> transfer{};
    sh::unoccludedTransfer(order, glm::vec3(0, 1, 0), transfer);
    double expected = 0.0;
    for (int i = 0; i < sh::coefficientCount(order); ++i)
      expected +=
          double{transfer[static_cast<std::size_t>(i)]} * double{light.c[static_cast<std::size_t>(i)].g};
    const auto seen = measured(floor, kEye, kPlace, {sun}, limited(256, order));
    expectMean(seen, expected);
    EXPECT_LT(seen.error.g, 0.01);
  }
}

TEST(BandLimit, IsSignedAndTurnsWithTheLight) {
  // Away from a small sun the expansion of order 3 rings below zero, and the picture says so.
  const Scene wall = sceneOf({testing::box({0, 0, 0}, {2, 2, 2}, 1)});
  const spec::SunLight sun{
      .azimuth_deg = 0, .elevation_deg = -32, .angle_deg = 8, .radiance = glm::vec3(100)};
  Options options = limited(256, 3);
  options.rotate_light_deg = 90.0f;  // to +X
  std::array<float, sh::kMaxCoefficients> transfer{};
  sh::unoccludedTransfer(3, glm::vec3(0, 1, 0), transfer);
  const auto light = spec::turned(spec::loadDistantLights({sun})->lightVector(), 90.0f).truncated(3);
  double expected = 0.0;
  for (std::size_t i = 0; i < 9; ++i) expected += double{transfer[i]} * double{light.c[i].g};
  EXPECT_LT(expected, -0.01);
  expectMean(measured(wall, {0.3f, 3, 0.4f}, {0.1f, 1, 0.2f}, {sun}, options), expected);
}

TEST(BandLimit, OfTheKernelCutsTheCosineAtTheFirstHit) {
  // Over an open plane under uniform light, with directions below the horizon blocked: band 0 of the cosine
  // is 1/4pi over 2pi steradians, half the answer; band 1 gives the other half; bands 2 and 4 integrate to 0
  // over a hemisphere.
  const Scene floor = sceneOf({testing::grid({0, 0, 0}, 4.0f, 1)});
  const auto seen = [&](int out) {
    return measured(floor, kEye, kPlace, {testing::uniform(1.0f)}, limited(256, 1, out));
  };
  expectMean(seen(1), 0.5);
  expectMean(seen(2), 1.0);
  expectMean(seen(5), 1.0);
  EXPECT_LT(seen(5).error.g, 0.01);
}

}  // namespace
}  // namespace lambent::baker::reference
