#include "runtime/sh/window.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/sh/sphere.hpp"
#include "tests/support/differences.hpp"

namespace lambent::sh {
namespace {

using testing::Random;

using testing::kDegree;

// Returns the least radiance of any channel over 20000 directions, relative to that channel's mean.
float leastRadiance(const LightVector& light) {
  float least = 1;
  for (int k = 0; k < 20000; ++k) {
    const glm::vec3 value = light.evaluate(glm::vec3(testing::fibonacciDirection(k, 20000)));
    for (int channel = 0; channel < 3; ++channel)
      least = lambent::testing::smaller(least, value[channel] / (light.c[0][channel] * 0.28209479f));
  }
  return least;
}

LightVector someLights(int order, Random& random) {
  LightVector light = constantLight(order, glm::vec3(0.01f));
  for (int k = 0; k < 3; ++k)
    light += discLight(order, glm::vec3(random.direction()), (2 + 20 * random.uniform()) * kDegree,
                       glm::vec3(random.uniform(), random.uniform(), random.uniform()));
  return light;
}

void expectEqual(const LightVector& a, const LightVector& b) {
  EXPECT_EQ(a.order, b.order);
  for (std::size_t i = 0; i < a.c.size(); ++i) EXPECT_EQ(a.c[i], b.c[i]) << i;
}

// Returns the blend of Auto, from what it leaves of band 1.
double blendOf(const LightVector& light) {
  return (1 - double{windowWeights(light, Window::Auto)[1]}) / (1 - double{positiveWeights(light.order)[1]});
}

TEST(ShWindow, AutoLeavesNoNegativeLight) {
  Random random(13);
  for (int order = 1; order <= kMaxOrder; ++order) {
    for (double degrees : {0.27, 5.0, 20.0, 60.0}) {
      const LightVector disc =
          discLight(order, glm::vec3(random.direction()), degrees * kDegree, {1, 10, 1000});
      EXPECT_GE(leastRadiance(applyWindow(disc, Window::Auto)), -1e-4f) << order << ", " << degrees;
    }
    for (int k = 0; k < 5; ++k)
      EXPECT_GE(leastRadiance(applyWindow(someLights(order, random), Window::Auto)), -1e-4f) << order;
  }
}

// For orders up to 8, k_1 is the largest zero of Legendre (odd orders) or Jacobi (0, 1) polynomials, from
// their tables.
TEST(ShWindow, PositiveKernelIsNowhereNegativeAndKeepsMostOfBandOne) {
  const double zeros[] = {
      0, 0, 1.0 / 3, 0.5773502692, 0.6898979486, 0.7745966692, 0.8228240810, 0.8611363116, 0.8857916077};
  for (int order = 2; order <= kMaxOrder; ++order) {
    const BandWeights weights = positiveWeights(order);
    EXPECT_FLOAT_EQ(weights[0], 1.0f);
    EXPECT_NEAR(weights[1], zeros[order], 1e-6) << order;
    double least = 1, most = 0;
    for (int step = 0; step <= 2000; ++step) {
      const double t = -1 + step / 1000.0;
      double sum = 0;
      for (int l = 0; l < order; ++l)
        sum += (2 * l + 1) * double{weights[static_cast<std::size_t>(l)]} * legendre(l, t);
      least = lambent::testing::smaller(least, sum), most = lambent::testing::larger(most, sum);
    }
    EXPECT_GE(least, -1e-5 * most) << order;
  }
  const BandWeights five = positiveWeights(5);
  for (const auto& [l, value] : {std::pair{2, 0.485714}, {3, 0.221313}, {4, 0.063492}})
    EXPECT_NEAR(five[static_cast<std::size_t>(l)], value, 1e-5);
}

// A point light at the limit needs the whole kernel, a broad disc only a part. A little less leaves negative
// values.
TEST(ShWindow, AutoIsTheLeastThatHelps) {
  for (int order : {3, 5, 7})
    for (double degrees : {1.0, 15.0, 30.0}) {
      const LightVector light = discLight(order, {0.48f, 0.64f, 0.6f}, degrees * kDegree, {1, 1, 1});
      const double blend = blendOf(light);
      ASSERT_GT(blend, 0.0);
      const BandWeights kernel = positiveWeights(order);
      const auto leastAt = [&](double a) {
        BandWeights weights{};
        for (std::size_t l = 0; l < weights.size(); ++l)
          weights[l] = static_cast<float>(1 - a + a * double{kernel[l]});
        return leastRadiance(applyWeights(light, weights));
      };
      EXPECT_GE(leastAt(blend), -1e-4f) << order << ", " << degrees;
      EXPECT_LT(leastAt(0.98 * blend), -1e-4f) << order << ", " << degrees;
    }
}

TEST(ShWindow, AutoStaysFiniteOnOddLights) {
  const LightVector none{.order = 5};
  expectEqual(applyWindow(none, Window::Auto), none);

  LightVector quadratic{.order = 5};
  quadratic.c[6] = {1, 1, 1};
  expectEqual(applyWindow(quadratic, Window::Auto), quadratic);  // mean 0: no window can help

  quadratic.c[0] = {1e-3f, 1e-3f, 1e-3f};  // hardly any mean, as no real light has: all that Auto can do
  EXPECT_EQ(blendOf(quadratic), 1.0);

  quadratic.c[0] = {1e-42f, -1, 1e-30f};  // means that vanish beside the rest
  expectEqual(applyWindow(quadratic, Window::Auto), quadratic);

  LightVector broken = discLight(5, {0, 1, 0}, 0.1, {1, 1, 1});
  broken.c[7].g = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(blendOf(broken), 0);

  LightVector red = discLight(5, {0, 1, 0}, 0.1, {1, 0, 0});  // two channels dark
  EXPECT_GT(blendOf(red), 0);
}

TEST(CachedWindow, AScaledLightKeepsTheWindowThatItWouldHave) {
  Random random(7);
  for (int i = 0; i < 50; ++i) {
    const LightVector light = someLights(5, random);
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
  Random random(10);
  const LightVector light = someLights(5, random), other = someLights(5, random);
  CachedWindow kept;
  for (const Window window : {Window::Auto, Window::Off}) {
    EXPECT_FALSE(kept.fits(light, window));
    kept.follow(light, window);
    EXPECT_EQ(kept.weights(), windowWeights(light, window));
    EXPECT_EQ(kept.fits(other, window), window != Window::Auto);
    EXPECT_FALSE(kept.fits(light.truncated(3), window));
  }
}

}  // namespace
}  // namespace lambent::sh
