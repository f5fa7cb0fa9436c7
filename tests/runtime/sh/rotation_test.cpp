#include "runtime/sh/rotation.hpp"

#include <array>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"
#include "tests/runtime/sh/sphere.hpp"
#include "tests/support/differences.hpp"

namespace lambent::sh {
namespace {

using testing::Random;

using testing::kDegree;

std::array<double, kMaxCoefficients> functionsAt(const glm::dvec3& dir) {
  std::array<double, kMaxCoefficients> y;
  evaluate(kMaxOrder, dir, y);
  return y;
}

// Lists axes through faces, edges and corners, and some in general position.
std::vector<glm::dvec3> axes() {
  std::vector<glm::dvec3> list = {{1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {0, 0, -1}, {1, 1, 0},
                                  {0, 1, 1}, {-1, 0, 1}, {1, 1, 1}, {1, -1, 1}, {1e-9, 0, 1}};
  Random random(4);
  for (int k = 0; k < 10; ++k) list.push_back(random.direction());
  for (glm::dvec3& axis : list) axis = glm::normalize(axis);
  return list;
}

std::vector<glm::dquat> rotations() {
  std::vector<glm::dquat> list;
  for (double angle : {0.0, 1e-8, 1.0, 90 * kDegree, 180 * kDegree, (180 - 1e-6) * kDegree, 270 * kDegree})
    for (const glm::dvec3& axis : axes()) list.push_back(glm::angleAxis(angle, axis));
  Random random(5);
  for (int k = 0; k < 50; ++k) list.push_back(random.rotation());
  return list;
}

// Checks y(R s) = D y(s) in double, in all bands: at special angles, about special axes, towards the poles.
TEST(ShRotation, TurnsTheBasisInAllBandsNearThePoles) {
  Random random(6);
  for (const glm::dquat& q : rotations()) {
    const glm::dmat3 matrix = glm::mat3_cast(q);
    const Rotation rotation(matrix, kMaxBasisOrder);
    for (const glm::dvec3& dir : {glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1), random.direction()}) {
      std::array<double, coefficientCount(kMaxBasisOrder)> y, expected, turned;
      evaluate(kMaxBasisOrder, dir, y);
      evaluate(kMaxBasisOrder, matrix * dir, expected);
      rotation.apply(y, std::span<double>(turned));
      EXPECT_LE(lambent::testing::largestDifference(turned, expected), 1e-12)
          << "quaternion " << q.w << " " << q.x << " " << q.y << " " << q.z;
    }
  }
}

TEST(ShRotation, IsOrthogonal) {
  for (const glm::dquat& q : rotations()) {
    const Rotation rotation(q, kMaxOrder);
    for (int i = 0; i < kMaxCoefficients; ++i)
      for (int j = 0; j <= i; ++j) {
        if (bandOf(i) != bandOf(j)) {
          EXPECT_EQ(rotation.entry(i, j), 0);
          continue;
        }
        double product = 0;
        for (int k = 0; k < kMaxCoefficients; ++k) product += rotation.entry(i, k) * rotation.entry(j, k);
        ASSERT_NEAR(product, i == j ? 1 : 0, 1e-12);
      }
  }
}

// Rotates light into the frame of a group and compares with an independent reference: lights of one direction
// each, whose directions are rotated, in double and with the textbook's functions.
TEST(ShRotation, TurnsLightVectorsAsTheirDirectionsTo1e5AtEveryOrder) {
  Random random(12);
  std::vector<glm::dquat> turns = rotations();
  for (const double angle : {1e-4, 1e-6, (90 + 1e-4) * kDegree, (180 - 1e-3) * kDegree})
    for (const glm::dvec3& axis : axes()) turns.push_back(glm::angleAxis(angle, axis));
  std::vector<glm::dvec3> dirs = {glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1),
                                  glm::normalize(glm::dvec3(1e-6, -1e-6, 1))};
  while (dirs.size() < 6) dirs.push_back(random.direction());
  for (int order = 1; order <= kMaxOrder; ++order)
    for (const glm::dquat& q : turns) {
      LightVector light{.order = order};
      std::array<glm::dvec3, kMaxCoefficients> expected{};
      for (const glm::dvec3& dir : dirs) {
        const glm::dvec3 colour(random.uniform(), random.uniform(), random.uniform());
        const auto y = testing::condonShortleySh(dir, order),
                   there = testing::condonShortleySh(q * dir, order);
        for (int l = 0; l < order; ++l)
          for (int m = -l; m <= l; ++m) {
            const auto i = static_cast<std::size_t>(coefficientIndex(l, m));
            const double sign = m % 2 ? -1 : 1;  // to our functions
            light.c[i] += glm::vec3(sign * y[i] * colour);
            expected[i] += sign * there[i] * colour;
          }
      }
      const LightVector turned = Rotation(q, order).apply(light);
      double error = 0;
      for (std::size_t i = 0; i < turned.c.size(); ++i) {
        const glm::dvec3 away = glm::dvec3(turned.c[i]) - expected[i];
        for (int channel = 0; channel < 3; ++channel)
          error = lambent::testing::larger(error, std::abs(away[channel]));
      }
      ASSERT_LE(error, 1e-5) << "order " << order << ", quaternion " << q.w << " " << q.x << " " << q.y << " "
                             << q.z;
    }
}

// Tests the documented way to rotate a body for hours: accumulate a quaternion and rebuild the matrix, of
// which the constructor normalises the quaternion.
TEST(ShRotation, DoesNotDriftOver100000SmallTurns) {
  constexpr int kTurns = 100250;  // 100 full turns and a quarter, since the identity shows no length
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 2, 3));
  const glm::dquat step = glm::angleAxis(360 * kDegree / 1000, axis);
  glm::dquat q(1, 0, 0, 0);
  // Nobody normalises on the way, and lengths grow far faster than by rounding, 2.7 times in all.
  for (int k = 0; k < kTurns; ++k) q = (1.0 + 1e-5) * (step * q);
  const glm::dvec3 dir = glm::normalize(glm::dvec3(-1, 0.5, 0.2));
  std::array<double, kMaxCoefficients> turned;
  Rotation(q, kMaxOrder).apply(functionsAt(dir), std::span<double>(turned));
  const auto expected = functionsAt(glm::angleAxis(90 * kDegree, axis) * dir);
  EXPECT_LE(lambent::testing::largestDifference(turned, expected), 1e-9);
}

TEST(ShRotation, FindsTheRotationInAScaledOrDriftedMatrix) {
  Random random(10);
  for (int k = 0; k < 20; ++k) {
    const glm::dmat3 exact = glm::mat3_cast(random.rotation());
    glm::dmat3 drifted = exact * 3.0;
    drifted[1] *= 0.5;
    drifted[0][2] += 1e-7;
    const auto found = orthonormalised(drifted);
    ASSERT_TRUE(found.has_value());
    EXPECT_TRUE(isRotation(*found, 1e-14));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR((*found)[i][j], exact[i][j], 1e-6);
  }
  glm::dmat3 mirror(1);
  mirror[2][2] = -1;
  EXPECT_FALSE(orthonormalised(mirror).has_value());
  EXPECT_FALSE(orthonormalised(glm::dmat3(0)).has_value());
  EXPECT_FALSE(orthonormalised(glm::dmat3(std::numeric_limits<double>::infinity())).has_value());
}

}  // namespace
}  // namespace lambent::sh
