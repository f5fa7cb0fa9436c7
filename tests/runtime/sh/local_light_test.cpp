// Compares local lights with quadrature over their solid angle and with suns, also in the hardest cases.
#include "runtime/sh/local_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/sh/sphere.hpp"
#include "tests/support/differences.hpp"

namespace lambent::sh {
namespace {

using testing::gaussLegendre;
using testing::Node;
using testing::Random;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const glm::vec3 kWhite(1.0f);
const glm::vec3 kWarm(3.0f, 2.0f, 0.5f);

using Coefficients = std::array<double, kMaxCoefficients>;

// Coefficients are floats: half a unit in the last place, and a little for the doubles before it.
constexpr double kRounding = 1.5e-7;

double largestDifference(const LightVector& light, const Coefficients& expected, int order) {
  double largest = 0;
  for (int i = 0; i < coefficientCount(order); ++i) {
    const auto k = static_cast<std::size_t>(i);
    largest = lambent::testing::larger(largest, std::abs(static_cast<double>(light.c[k].r) - expected[k]));
  }
  return largest;
}

bool allFinite(const LightVector& light) {
  return std::all_of(light.c.begin(), light.c.end(), [](const glm::vec3& c) {
    return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
  });
}
bool dark(const LightVector& light) {
  return std::all_of(light.c.begin(), light.c.end(), [](const glm::vec3& c) { return c == glm::vec3(0.0f); });
}

// Integrates y_i over the disc of radius 1 whose centre is `aside` beside and `height` ahead of the point, in
// polar angles about the normal through the point. The integrand is smooth, however near the disc is.
Coefficients discByQuadrature(double aside, double height, const glm::dquat& turn) {
  Coefficients sum{}, y;
  const auto ray = [&](double psi, double weight, double from_radius, double to_radius) {
    const double from = std::atan(from_radius / height), to = std::atan(to_radius / height);
    for (const Node& theta : gaussLegendre(24, from, to)) {
      const double r = std::sin(theta.at);
      evaluate(kMaxOrder, turn * glm::dvec3(r * std::cos(psi), r * std::sin(psi), std::cos(theta.at)), y);
      for (std::size_t i = 0; i < y.size(); ++i) sum[i] += weight * theta.weight * r * y[i];
    }
  };
  if (aside < 1) {
    constexpr int kRays = 2000;
    for (int k = 0; k < kRays; ++k) {
      const double psi = 2 * kPi * k / kRays, s = aside * std::sin(psi);
      ray(psi, 2 * kPi / kRays, 0, aside * std::cos(psi) + std::sqrt(1 - s * s));
    }
  } else {
    for (const Node& tau : gaussLegendre(300, -kPi / 2, kPi / 2)) {
      const double psi = std::asin(std::sin(tau.at) / aside), half = std::cos(tau.at),
                   middle = aside * std::cos(psi);
      ray(psi, tau.weight * half / middle, middle - half, middle + half);
    }
  }
  return sum;
}

TEST(ShLocalLight, DiscsAreWhatTheirSolidAngleHolds) {
  Random random(31);
  for (const double aside : {0.0, 1e-9, 0.3, 0.9, 0.99, 0.999, 1.001, 1.01, 1.2, 3.0, 40.0, 5000.0})
    for (const double height : {2e-4, 1e-3, 0.05, 0.5, 1.0, 7.0, 300.0}) {
      const glm::dquat turn = random.rotation();
      const double radius = std::exp(6 * random.uniform() - 3);
      const glm::dvec3 center = radius * (turn * glm::dvec3(aside, 0, height)),
                       normal = 2.5 * (turn * glm::dvec3(0, 0, -1));
      const Coefficients expected = discByQuadrature(aside, height, turn);
      const double solid_angle = expected[0] * std::sqrt(4 * kPi);
      const double error =
          largestDifference(discAreaLight(kMaxOrder, center, normal, radius, kWhite), expected, kMaxOrder);
      // Seen edge-on, the rim's two sides cancel up to the rounding of its length.
      const double edge_on = 2 * kPi / std::max(1.0, aside) * 1e-16;
      EXPECT_LT(error, 4 * kRounding * solid_angle + edge_on)
          << "aside " << aside << " radii, " << height << " before the plane";
    }
}

TEST(ShLocalLight, ASphereIsASunOfItsAngle) {
  for (const double distance : {1.0001, 1.5, 4.0, 1e5}) {
    const glm::dvec3 to = glm::normalize(glm::dvec3(-1, 0.5, 3));
    const LightVector sphere = sphereLight(kMaxOrder, 0.7 * distance * to, 0.7, kWarm),
                      sun = discLight(kMaxOrder, glm::vec3(to), std::asin(1 / distance), kWarm);
    for (std::size_t i = 0; i < sphere.c.size(); ++i)
      EXPECT_LT(glm::distance(sphere.c[i], sun.c[i]), 5e-6f * sun.c[0].r) << distance << " " << i;
  }
  for (const glm::dvec3 inside : {glm::dvec3(0), glm::dvec3(0.1, 0, 0.2), glm::dvec3(0, 0.7, 0)}) {
    const LightVector all = sphereLight(kMaxOrder, inside, 0.7, kWarm);
    EXPECT_EQ(all.c, constantLight(kMaxOrder, kWarm).c);
  }
}

// Tests Lambert's cosine law in harmonics: irradiance of bands 0..2 is known for a point light overhead.
TEST(ShLocalLight, PointsShineByTheInverseSquareAndOneDirection) {
  Random random(32);
  for (int k = 0; k < 20; ++k) {
    const glm::dvec3 dir = random.direction();
    const double distance = std::exp(5 * random.uniform() - 3);
    std::array<double, kMaxCoefficients> y;
    evaluate(kMaxOrder, dir, y);
    const LightVector point = pointLight(kMaxOrder, distance * dir, kWarm),
                      far = directionalLight(kMaxOrder, distance * dir, kWarm);
    for (std::size_t i = 0; i < y.size(); ++i) {
      EXPECT_NEAR(point.c[i].r, 3 * y[i] / (distance * distance), 1e-6 * 3 / (distance * distance));
      EXPECT_NEAR(far.c[i].g, 2 * y[i], 1e-6);
    }
  }
  EXPECT_TRUE(dark(pointLight(5, {0, 3, 0}, kWarm, 3.0))) << "the end of its range";
  EXPECT_NEAR(pointLight(5, {0, 1, 0}, kWhite, 2.0).c[0].r,
              pointLight(5, {0, 1, 0}, kWhite).c[0].r * (1 - 1.0 / 16), 1e-7);
}

TEST(ShLocalLight, SpotsFadeFromTheInnerConeToTheOuter) {
  const glm::dvec3 axis(0, -2, 0);
  const double inner = 0.3, outer = 0.8;
  const auto strength = [&](double angle) {
    // The point lies `angle` off the axis, one metre from the light.
    const glm::dvec3 light_from_point = -glm::dvec3(std::sin(angle), -std::cos(angle), 0);
    return spotLight(5, light_from_point, {axis, inner, outer}, kWhite).c[0].r /
           pointLight(5, light_from_point, kWhite).c[0].r;
  };
  EXPECT_FLOAT_EQ(strength(0.0), 1.0f);
  EXPECT_FLOAT_EQ(strength(0.29), 1.0f);
  EXPECT_EQ(strength(0.81), 0.0f);
  const double half = (std::cos(0.55) - std::cos(outer)) / (std::cos(inner) - std::cos(outer));
  EXPECT_NEAR(strength(0.55), half * half, 1e-6);
  EXPECT_TRUE(std::isfinite(coneFade(0.5, 0.8, 0.8))) << "no cone between";
}

// Moves a point through the light: no coefficient jumps, measured by the largest change in one step.
TEST(ShLocalLight, APointLightPassesThroughThePointWithoutAJump) {
  const double step = kLeastPointDistance / 200;
  LightVector before = pointLight(kMaxOrder, {-2 * kLeastPointDistance, 0.0, 0.0}, kWhite);
  const float whole = before.c[0].r * 4.0f;
  for (int k = 1; k <= 800; ++k) {
    const LightVector now = pointLight(kMaxOrder, {-2 * kLeastPointDistance + k * step, 0.0, 0.0}, kWhite);
    for (std::size_t i = 0; i < now.c.size(); ++i)
      ASSERT_LT(std::abs(now.c[i].r - before.c[i].r), 0.2f * whole) << k << " " << i;
    before = now;
  }
  const LightVector at = pointLight(kMaxOrder, {0, 0, 0}, kWhite);
  for (std::size_t i = 1; i < at.c.size(); ++i) EXPECT_EQ(at.c[i].r, 0.0f) << "from all around";
}

TEST(ShLocalLight, AtTheRimADiscIsHalfTheSkyBeforeIt) {
  // From just before the plane the rim is a straight line through the point, and the disc fills a quarter of
  // all directions. Within a ten thousandth of a radius beside the rim the answer may be that of the rim.
  for (const double height : {5e-5, 1e-6, 1e-9, 1e-12, 1e-15})
    for (const double aside : {1.0, 1.0 + 0.3 * height, 1.0 - 0.3 * height}) {
      const LightVector light = discAreaLight(kMaxOrder, {aside, 0, height}, {0, 0, -1}, 1.0, kWhite);
      const double turned = std::atan((aside - 1.0) / height);  // of the rim, seen from the point
      EXPECT_NEAR(double{light.c[0].r} * std::sqrt(4 * kPi), kPi, 2.0 * std::abs(turned) + 0.01)
          << height << " before the plane, " << aside << " radii aside";
    }
}

TEST(ShLocalLight, HardCasesStayFinite) {
  const glm::vec3 bright(1e8f);
  const glm::dvec3 down(0, -1, 0);
  EXPECT_TRUE(dark(discAreaLight(8, {0, 0, 0}, down, 1, bright))) << "at the point";
  EXPECT_TRUE(dark(discAreaLight(8, {3, 0, 0}, down, 1, bright))) << "in its plane";
  EXPECT_TRUE(dark(discAreaLight(8, {1, 0, 0}, down, 1, bright))) << "at its rim";
  EXPECT_TRUE(dark(discAreaLight(8, {0, -1, 0}, down, 1, bright))) << "behind it";
  EXPECT_TRUE(dark(discAreaLight(8, {0, 1, 0}, down, 0, bright)));
  EXPECT_TRUE(dark(discAreaLight(8, {0, 1, 0}, {0, 0, 0}, 1, bright)));
  EXPECT_TRUE(dark(sphereLight(8, {0, 0, 0}, 0, bright)));
  EXPECT_TRUE(dark(sphereLight(8, {0, 1, 0}, -1, bright)));
  EXPECT_TRUE(dark(directionalLight(8, {0, 0, 0}, bright)));
  EXPECT_TRUE(dark(spotLight(8, {0, 1, 0}, {{0, 0, 0}, 0, 1}, bright)));
  for (const double wrong : {kNaN, kInfinity}) {
    EXPECT_TRUE(dark(sphereLight(8, {0, wrong, 0}, 1, bright)));
    EXPECT_TRUE(dark(discAreaLight(8, {0, wrong, 0}, down, 1, bright)));
    EXPECT_TRUE(dark(discAreaLight(8, {0, 1, 0}, {wrong, 0, 0}, 1, bright)));
    EXPECT_TRUE(dark(discAreaLight(8, {0, 1, 0}, down, wrong, bright)));
    EXPECT_TRUE(dark(pointLight(8, {wrong, 0, 0}, bright)));
    EXPECT_TRUE(dark(spotLight(8, {0, wrong, 0}, {down, 0, 1}, bright)));
  }
  // Rims as near as can be, from all sides, and everything from tiny to huge.
  for (const double x : {1.0, 1.0 + 1e-15, 1.0 - 1e-15, 1.0 + 1e-7, 1.0 - 1e-7, 0.0, 1e-300, 1e-9})
    for (const double y : {0.0, 1e-300, 1e-15, 1e-7, 1e-4, 1.0, 1e9, 1e30})
      for (const double scale : {1e-30, 1e-3, 1.0, 1e6, 1e30}) {
        const glm::dvec3 place = scale * glm::dvec3(x, y, 0);
        const LightVector disc = discAreaLight(8, place, down, scale, bright);
        EXPECT_TRUE(allFinite(disc)) << x << " " << y << " " << scale;
        // The bound is half the sky: sqrt(pi) in band 0, and as much times the largest y in others.
        for (const glm::vec3& c : disc.c) EXPECT_LT(std::abs(c.r), 1.01e8f * 2 * 3.1416f * 1.2f);
        EXPECT_TRUE(allFinite(sphereLight(8, place, scale, bright)));
        EXPECT_TRUE(allFinite(pointLight(8, place, bright)));
        EXPECT_TRUE(allFinite(spotLight(8, place, {down, 0.0, 0.0}, bright)));
        EXPECT_TRUE(allFinite(directionalLight(8, place, bright)));
      }
}

}  // namespace
}  // namespace lambent::sh
