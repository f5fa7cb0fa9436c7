
#include <gtest/gtest.h>

#include "runtime/sh/window.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/sh/sphere.hpp"

namespace lambent::sh {
namespace {

LightVector someLight(testing::Random& random, int order = 5) {
  LightVector light = constantLight(order, glm::vec3(0.05f));
  for (int k = 0; k < 3; ++k)
    light += discLight(order, glm::vec3(random.direction()), 0.1 + 0.3 * random.uniform(),
                       glm::vec3(random.uniform(), random.uniform(), random.uniform()));
  return light;
}

}  // namespace

TEST(CachedWindow, AScaledLightKeepsTheWindowThatItWouldHave) {
  testing::Random random(7);
  for (int i = 0; i < 50; ++i) {
    const LightVector light = someLight(random);
    CachedWindow kept;
    kept.follow(light, Window::Auto);
    EXPECT_EQ(kept.weights(), windowWeights(light, Window::Auto));
    const BandWeights before = kept.weights();
    const LightVector scaled =
        light * glm::vec3(0.01 + random.uniform(), 7.3 * (0.01 + random.uniform()), 300.0f);
    EXPECT_TRUE(kept.fits(scaled, Window::Auto)) << i;
    kept.follow(scaled, Window::Auto);
    EXPECT_EQ(kept.weights(), before);
    // The result equals that of a new search, up to the search's tolerance.
    const BandWeights searched = windowWeights(scaled, Window::Auto);
    for (std::size_t l = 0; l < searched.size(); ++l) EXPECT_NEAR(kept.weights()[l], searched[l], 1e-3f);
  }
}

TEST(CachedWindow, WindowsThatDoNotLookAtTheLightFollowItsOrderAndTheirKind) {
  testing::Random random(10);
  const LightVector light = someLight(random), other = someLight(random);
  CachedWindow kept;
  for (const Window window : {Window::Hann, Window::Off, Window::Auto}) {
    EXPECT_FALSE(kept.fits(light, window));
    kept.follow(light, window);
    EXPECT_EQ(kept.weights(), windowWeights(light, window));
    EXPECT_EQ(kept.fits(other, window), window != Window::Auto);
    EXPECT_FALSE(kept.fits(light.truncated(3), window));
  }
}

}  // namespace lambent::sh
