#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "baker/brdf/brdf.hpp"
#include "baker/import/measured_brdf.hpp"
#include "tests/baker/brdf/quadrature.hpp"
#include "tests/reference/quadrature.hpp"
#include "tests/runtime/sh/sphere.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent::baker {
namespace {

using sh::testing::Random;
using testing::kPi;

glm::dvec3 directionOf(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Makes scattered pairs of directions, with values given by a function of both.
template <typename F>
MeasuredBrdf measure(std::size_t count, F&& f) {
  MeasuredBrdf measured{.name = "made.brdf", .measurements = {}};
  Random random(31);
  for (std::size_t i = 0; i < count; ++i) {
    BrdfMeasurement m;
    m.theta_i = static_cast<float>(1.45 * random.uniform());
    m.theta_o = static_cast<float>(1.45 * random.uniform());
    m.phi_o = static_cast<float>(2 * kPi * random.uniform());
    m.value = f(directionOf(m.theta_i, 0), directionOf(m.theta_o, m.phi_o));
    measured.measurements.push_back(m);
  }
  return measured;
}

std::array<double, 3> valueOf(const Brdf& brdf, const glm::dvec3& v, const glm::dvec3& s) {
  std::array<double, 3> f{};
  brdf.value({}, v, s, f);
  return f;
}

double albedo(const Brdf& brdf, double cosine, std::size_t channel, double tolerance = 1e-6) {
  const glm::dvec3 v(std::sqrt(1 - cosine * cosine), 0, cosine);
  return testing::HemisphereIntegral(tolerance)(
      [&](const glm::dvec3& s) { return valueOf(brdf, v, s)[channel] * s.z; });
}

TEST(MeasuredBrdf, ThatIsTheSameEverywhereIsLambert) {
  const auto brdf = makeMeasured(measure(200, [](auto&&...) { return glm::vec3(0.2f, 0.1f, 0.0f); }));
  ASSERT_TRUE(brdf);
  EXPECT_EQ((*brdf)->lobes(), 3u);
  EXPECT_TRUE((*brdf)->isotropic());
  const auto table = integrateTable(**brdf, 5);
  EXPECT_EQ(table.roughnesses, 1u);
  std::vector<float> b(75);
  for (const float cosine : {0.0f, 0.01f, 0.3f, 1.0f}) {
    lookUp(table, {.cos_theta = cosine}, 0.0f, 0.0f, b);
    EXPECT_NEAR(b[0], 0.2 * kPi / std::sqrt(4 * kPi), 3e-4);
    EXPECT_NEAR(b[2], 0.2 * 2 * kPi / 3 * std::sqrt(3 / (4 * kPi)), 3e-4);
    EXPECT_NEAR(b[25], 0.5 * b[0], 1e-6);
    EXPECT_EQ(b[50], 0.0f);
  }
}

// Evaluates the formula of the conventions directly: weights exp(-400 |p - p_i|²), p = (sqrt(2 theta_h / pi),
// 2 theta_d / pi).
TEST(MeasuredBrdf, IsTheWeighedMeanOverHalfVectorAndDifference) {
  const auto shine = [](const glm::dvec3& v, const glm::dvec3& s) {
    const double z = glm::normalize(v + s).z;
    return glm::vec3(static_cast<float>(0.05 + 0.3 * std::pow(z, 20)), 0.1f, static_cast<float>(0.1 * z));
  };
  const MeasuredBrdf measured = measure(800, shine);
  const auto brdf = makeMeasured(measured);
  ASSERT_TRUE(brdf);
  Random random(7);
  for (int k = 0; k < 60; ++k) {
    const glm::dvec3 v = directionOf(1.4 * random.uniform(), 0),
                     s = directionOf(1.4 * random.uniform(), 6 * random.uniform());
    const glm::dvec3 expected = lambent::testing::weighedMean(measured, v, s);
    const auto found = valueOf(**brdf, v, s);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(found[static_cast<std::size_t>(c)], expected[c], 2e-3 * expected[c]) << k;
  }
}

// A BRDF twice as bright as white in all directions is scaled down to 1 and no further, and stays reciprocal.
TEST(MeasuredBrdf, ThatReflectsMoreThanItReceivesIsScaledDown) {
  const auto brdf = makeMeasured(measure(400, [](const glm::dvec3& v, const glm::dvec3& s) {
    return glm::vec3(static_cast<float>(2 / kPi * (1 + 0.3 * glm::dot(v, s))), 0.1f, 0.2f);
  }));
  ASSERT_TRUE(brdf);
  for (const double cosine : {0.05, 0.4, 0.9}) {
    EXPECT_LE(albedo(**brdf, cosine, 0), 1.0);
    EXPECT_GT(albedo(**brdf, cosine, 0), 0.3);
  }
  Random random(3);
  for (int k = 0; k < 100; ++k) {
    const glm::dvec3 v = directionOf(1.5 * random.uniform(), 6 * random.uniform()),
                     s = directionOf(1.5 * random.uniform(), 6 * random.uniform());
    EXPECT_NEAR(valueOf(**brdf, v, s)[0], valueOf(**brdf, s, v)[0], 1e-12);
  }
}

TEST(MeasuredBrdf, WithTooFewDirectionsIsRefusedByName) {
  const auto brdf = makeMeasured(measure(3, [](auto&&...) { return glm::vec3(0.1f); }));
  ASSERT_FALSE(brdf);
  EXPECT_EQ(brdf.error().subject, "made.brdf");
}

class CornellBrdf : public ::testing::TestWithParam<const char*> {};

TEST_P(CornellBrdf, IsFiniteReciprocalAndKeepsEnergyWhereNothingWasMeasuredToo) {
  const auto file = lambent::testing::sharedFile(std::string("brdf/") + GetParam());
  LAMBENT_NEEDS_SHARED(file);
  const auto measured = readMeasuredBrdf(file);
  ASSERT_TRUE(measured) << measured.error().line();
  const auto brdf = makeMeasured(*measured);
  ASSERT_TRUE(brdf);
  Random random(9);
  for (int k = 0; k < 500; ++k) {
    const glm::dvec3 v = directionOf(1.5707 * std::sqrt(random.uniform()), 6.3 * random.uniform()),
                     s = directionOf(1.5707 * std::sqrt(random.uniform()), 6.3 * random.uniform());
    const auto there = valueOf(**brdf, v, s), back = valueOf(**brdf, s, v);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_TRUE(std::isfinite(there[c]));
      EXPECT_GE(there[c], 0.0);
      EXPECT_NEAR(there[c], back[c], 1e-9 * (1 + there[c]));
    }
  }
  // The table holds the albedo of an independent quadrature, at most 1.
  const auto table = integrateTable(**brdf, 5);
  std::vector<float> b(75);
  for (const float cosine : {0.02f, 0.15f, 0.4f, 0.75f, 1.0f}) {
    lookUp(table, {.cos_theta = cosine}, 0.0f, 0.0f, b);
    for (std::size_t c = 0; c < 3; ++c) {
      const double found = std::sqrt(4 * kPi) * static_cast<double>(b[c * 25]);
      EXPECT_NEAR(found, albedo(**brdf, static_cast<double>(cosine), c), 0.005)
          << "cos " << cosine << ", channel " << c;
      EXPECT_LE(found, 1.0 + 1e-3);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Files, CornellBrdf, ::testing::Values("acryl_blue.brdf", "garnet_red.brdf"),
                         [](const auto& file) { return std::string(file.param).substr(0, 6); });

}  // namespace
}  // namespace lambent::baker
