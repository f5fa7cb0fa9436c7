#include "runtime/scene/affine.hpp"

#include <cmath>
#include <random>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/scene/components.hpp"
#include "tests/runtime/scene/values.hpp"
#include "tests/support/differences.hpp"

namespace lambent::scene {
namespace {

float largestDifference(const glm::mat4& a, const glm::mat4& b) {
  float largest = 0.0f;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) largest = testing::larger(largest, std::abs(a[j][i] - b[j][i]));
  }
  return largest;
}

float roundTripError(const glm::mat4& matrix) {
  Transform transform;
  setLocalMatrix(transform, matrix);
  return largestDifference(localMatrix(transform), matrix);
}

glm::quat randomTurn(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return glm::normalize(glm::quat(normal(random), normal(random), normal(random), normal(random)));
}

using testing::kRounding;

TEST(Affine, TranslationRotationScaleComeBackAsTheyWere) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> size(0.1f, 3.0f);
  for (int i = 0; i < 200; ++i) {
    Transform made;
    made.translation = {size(random), -size(random), size(random)};
    made.rotation = randomTurn(random);
    made.scale = {size(random), size(random), size(random)};
    Transform found;
    setLocalMatrix(found, localMatrix(made));
    EXPECT_NEAR(std::abs(glm::dot(found.rotation, made.rotation)), 1.0f, kRounding);
    EXPECT_LT(glm::distance(found.scale, made.scale), kRounding);
    EXPECT_LT(glm::length(found.shear), 10.0f * kRounding)
        << "scales of 0.1 against 3 divide the rounding by 0.1";
    EXPECT_EQ(found.translation, made.translation);
  }
}

TEST(Affine, AnyMatrixMirroredOrShearedRoundTrips) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> entry(-2.0f, 2.0f);
  int mirrored = 0;
  for (int i = 0; i < 500; ++i) {
    glm::mat4 matrix(1.0f);
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 3; ++k) matrix[j][k] = entry(random);
    }
    mirrored += glm::determinant(matrix) < 0.0f ? 1 : 0;
    EXPECT_LT(roundTripError(matrix), kRounding);
  }
  EXPECT_GT(mirrored, 100);
}

TEST(Affine, PolarRotationIgnoresAnyStretchAlongAnyAxes) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> stretch(-3.0, 3.0);  // 1e-3 .. 1e3
  for (int i = 0; i < 200; ++i) {
    const glm::quat turn = randomTurn(random);
    const glm::dmat3 axes = glm::mat3_cast(glm::dquat(randomTurn(random)));
    glm::dmat3 sizes(0.0);
    // Lengths within a factor of 100 of each other, at any overall size.
    const double overall = std::pow(10.0, stretch(random));
    for (int j = 0; j < 3; ++j) sizes[j][j] = overall * std::pow(10.0, stretch(random) / 3.0);
    const auto found = polarRotation(glm::mat3_cast(glm::dquat(turn)) * axes * sizes * glm::transpose(axes));
    ASSERT_TRUE(found);
    EXPECT_NEAR(std::abs(glm::dot(*found, turn)), 1.0f, kRounding);
  }
}

TEST(Affine, FlatAndMirroredMatricesHaveNoRotation) {
  glm::dmat3 flat(1.0), mirror(1.0), nan(1.0);
  flat[2][2] = 0.0;
  mirror[0][0] = -1.0;
  nan[1][1] = std::nan("");
  EXPECT_FALSE(polarRotation(flat));
  EXPECT_FALSE(polarRotation(mirror));
  EXPECT_FALSE(polarRotation(nan));
  EXPECT_FALSE(polarRotation(glm::dmat3(0.0)));
}

}  // namespace
}  // namespace lambent::scene
