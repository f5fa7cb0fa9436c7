#include "runtime/sh/window.hpp"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/sh/sphere.hpp"

namespace lambent::sh {
namespace {

using testing::Random;

constexpr double kDegree = std::numbers::pi / 180;

// The least irradiance/pi of any channel over 20000 directions, relative to that channel's mean.
float leastIrradiance(const LightVector& light) {
  const LightVector irradiance = cosineConvolved(light);
  float least = 1;
  for (int k = 0; k < 20000; ++k) {
    const glm::vec3 value = irradiance.evaluate(glm::vec3(testing::fibonacciDirection(k, 20000)));
    for (int channel = 0; channel < 3; ++channel)
      least = std::min(least, value[channel] / (irradiance.c[0][channel] * 0.28209479f));
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

TEST(ShWindow, AutoLeavesNoNegativeIrradiance) {
  Random random(13);
  for (int order = 1; order <= kMaxOrder; ++order) {
    for (double degrees : {0.27, 5.0, 20.0, 60.0}) {
      const LightVector disc =
          discLight(order, glm::vec3(random.direction()), degrees * kDegree, {1, 10, 1000});
      EXPECT_GE(leastIrradiance(applyWindow(disc, Window::Auto)), -1e-5f) << order << ", " << degrees;
    }
    for (int k = 0; k < 5; ++k)
      EXPECT_GE(leastIrradiance(applyWindow(someLights(order, random), Window::Auto)), -1e-5f) << order;
  }
}

// A point light about z: lambda from a scan over the angle alone, in double.
TEST(ShWindow, AutoIsTheLeastThatHelps) {
  for (int order : {3, 5, 7}) {
    const auto least = [order](double lambda) {
      double minimum = 1;
      for (int step = 0; step <= 20000; ++step) {
        const double t = std::cos(step * std::numbers::pi / 20000);
        double sum = 0;
        for (int l = 0; l < order; ++l)
          sum += clampedCosine(l) / std::numbers::pi * (2 * l + 1) * legendre(l, t) /
                 (1 + lambda * l * l * (l + 1.0) * (l + 1.0));
        minimum = std::min(minimum, sum);
      }
      return minimum;
    };
    double low = 0, high = 1;
    for (int k = 0; k < 40; ++k) (least(0.5 * (low + high)) < 0 ? low : high) = 0.5 * (low + high);
    const double found = deringingLambda(discLight(order, {0.48f, 0.64f, 0.6f}, 1e-4, {1, 1, 1}));
    // The search aims at 1e-5 above 0, which costs it about as much in lambda, relative to lambda near 1e-2.
    EXPECT_NEAR(found / high, 1, 2e-3) << "order " << order;
  }
}

TEST(ShWindow, AutoLeavesLightsAloneThatDoNotRing) {
  for (int order = 1; order <= kMaxOrder; ++order) {
    for (const LightVector& light :
         {constantLight(order, {1, 2, 3}), discLight(order, {0, 0.6f, 0.8f}, 90 * kDegree, {1, 2, 3}),
          constantLight(order, {1, 1, 1}) + discLight(order, {1, 0, 0}, 10 * kDegree, {1, 1, 1})})
      expectEqual(applyWindow(light, Window::Auto), light);
  }
}

TEST(ShWindow, AutoStaysFiniteOnOddLights) {
  const LightVector none{.order = 5};
  expectEqual(applyWindow(none, Window::Auto), none);

  LightVector quadratic{.order = 5};
  quadratic.c[6] = {1, 1, 1};
  expectEqual(applyWindow(quadratic, Window::Auto), quadratic);  // mean 0: no window can help

  quadratic.c[0] = {1e-3f, 1e-3f, 1e-3f};  // hardly any mean: only a very strong window helps
  EXPECT_GE(leastIrradiance(applyWindow(quadratic, Window::Auto)), -1e-5f);

  quadratic.c[0] = {1e-42f, -1, 1e-30f};  // means that vanish beside the rest
  expectEqual(applyWindow(quadratic, Window::Auto), quadratic);

  LightVector broken = discLight(5, {0, 1, 0}, 0.1, {1, 1, 1});
  broken.c[7].g = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(deringingLambda(broken), 0);

  LightVector red = discLight(5, {0, 1, 0}, 0.1, {1, 0, 0});  // two channels dark
  EXPECT_GT(deringingLambda(red), 0);
}

TEST(ShWindow, AutoDoesNotDependOnRotationOrScale) {
  Random random(14);
  for (int k = 0; k < 10; ++k) {
    const LightVector light = someLights(5, random);
    const double lambda = deringingLambda(light);
    const double scaled = deringingLambda(light * 1e6f);
    const double turned = deringingLambda(Rotation(random.rotation(), 5).apply(light));
    // Minima are found to 2e-5 of the mean; weights move by less than that times the light's contrast.
    const auto a = laplacianWeights(5, lambda), b = laplacianWeights(5, scaled),
               c = laplacianWeights(5, turned);
    for (std::size_t l = 0; l < 5; ++l) {
      EXPECT_NEAR(a[l], b[l], 1e-4f);
      EXPECT_NEAR(a[l], c[l], 1e-3f);
    }
  }
}

TEST(ShWindow, HannFallsFromOneToZeroBeyondTheLastBand) {
  const BandWeights weights = windowWeights(constantLight(4, {1, 1, 1}), Window::Hann);
  EXPECT_FLOAT_EQ(weights[0], 1);
  EXPECT_FLOAT_EQ(weights[2], 0.5f);
  EXPECT_NEAR(weights[1] + weights[3], 1, 1e-6f);
  EXPECT_EQ(weights[4], 0);
  const LightVector light = discLight(5, {0, 1, 0}, 0.1, {1, 1, 1});
  expectEqual(applyWindow(light, Window::Off), light);
}

}  // namespace
}  // namespace lambent::sh
