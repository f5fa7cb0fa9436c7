// Tests the sampling of environment maps and discs: densities integrate to one, and samples find all of the
// light.
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "reference/lights.hpp"
#include "reference/sampler.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker::reference {
namespace {

spec::EnvironmentMap environment_map(sh::ImageLayout layout, std::uint32_t width, std::uint32_t height) {
  std::mt19937 random(7);
  std::lognormal_distribution<float> value(0.0f, 1.5f);
  spec::EnvironmentMap out{{width, height, {}}, layout};
  for (std::uint32_t i = 0; i < width * height; ++i)
    out.image.texels.emplace_back(value(random), value(random), value(random));
  return out;
}

// Compares means over many points by sampling with those by evaluating all directions.
void expectSamplesBringTheLight(const spec::DistantLights& lights, double tolerance) {
  const Environment environment(lights, 35.0f, 0);
  ASSERT_TRUE(environment.sampled());
  const Sampler sampler(3, 4, 5);
  constexpr std::uint32_t kCount = 1u << 16;
  double by_samples = 0.0, by_sphere = 0.0, density = 0.0;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const glm::vec3 dir = environment.sample(sampler.pair(0, i).x, sampler.pair(1, i));
    if (dir != glm::vec3(0.0f)) {
      EXPECT_NEAR(glm::length(dir), 1.0f, 1e-5f);
      const auto look = environment.look(dir);
      // Texels are looked up in float: right at a border the result may be the adjacent black one.
      if (look.pdf > 0.0f) by_samples += double{look.radiance.g} / double{look.pdf} / kCount;
    }
    const auto look = environment.look(sphereDirection(sampler.pair(2, i)));
    by_sphere += 4.0 * std::numbers::pi * double{look.radiance.g} / kCount;
    density += 4.0 * std::numbers::pi * double{look.pdf} / kCount;
  }
  EXPECT_NEAR(density, 1.0, tolerance);
  EXPECT_NEAR(by_samples / by_sphere, 1.0, tolerance);
  const double whole = double{lights.lightVector().c[0].g} * std::sqrt(4.0 * std::numbers::pi);
  EXPECT_NEAR(by_samples / whole, 1.0, tolerance) << "the power of the light vector";
}

TEST(Environment, SamplesProbesOfEveryLayout) {
  // 65536 stratified points are used; the rest of the error comes from texel borders and the angular map's
  // rim.
  for (const auto& [layout, width, height] :
       {std::tuple{sh::ImageLayout::LatLong, 32u, 16u}, std::tuple{sh::ImageLayout::AngularMap, 32u, 32u},
        std::tuple{sh::ImageLayout::VerticalCross, 24u, 32u}}) {
    SCOPED_TRACE(sh::name(layout));
    spec::DistantLights lights;
    lights.environment_maps = {environment_map(layout, width, height)};
    expectSamplesBringTheLight(lights, layout == sh::ImageLayout::AngularMap ? 0.03 : 0.01);
  }
}

TEST(Environment, FindsSmallSunsToTheDigit) {
  // At 0.01 degrees the cosine of the radius differs from 1 by a tenth of a float's rounding.
  spec::DistantLights lights;
  lights.discs = {
      {.direction = glm::normalize(glm::vec3(1, 2, 3)), .radius_rad = 1.7e-4f, .radiance = glm::vec3(1e7f)}};
  const Environment environment(lights, 20.0f, 0);
  const Sampler sampler(1, 1, 1);
  int found = 0;
  for (std::uint32_t i = 0; i < 1000; ++i)
    found += environment.look(environment.sample(0.5f, sampler.pair(0, i))).pdf > 0.0f;
  EXPECT_GT(found, 990);  // rounding of directions at the rim
}

}  // namespace
}  // namespace lambent::baker::reference
