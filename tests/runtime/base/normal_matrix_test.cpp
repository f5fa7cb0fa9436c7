#include "runtime/base/normal_matrix.hpp"

#include <glm/gtc/matrix_inverse.hpp>
#include <gtest/gtest.h>

#include "runtime/base/finite.hpp"

namespace lambent {
namespace {

const glm::dmat3 kShear(1.0, 0.2, -0.1, 0.3, 2.0, 0.4, -0.5, 0.1, 3.0);

TEST(NormalMatrix, PointsWhereTheInverseTransposeDoesAlsoInAMirror) {
  for (const double mirror : {1.0, -1.0}) {
    const glm::dmat3 linear = kShear * glm::dmat3(mirror, 0, 0, 0, 1, 0, 0, 0, 1);
    const glm::dvec3 normal(0.6, -0.48, 0.64);
    const glm::dvec3 expected = glm::normalize(glm::inverseTranspose(linear) * normal);
    EXPECT_LT(glm::distance(glm::normalize(normalMatrix(linear) * normal), expected), 1e-14);
  }
}

TEST(NormalMatrix, OfAMeshThatIsFlattenedToAPlaneIsThePlanesNormal) {
  for (const double thin : {0.0, 1e-20, 1e-40, 1e-150}) {
    const glm::dmat3 linear = kShear * glm::dmat3(1, 0, 0, 0, thin, 0, 0, 0, 1);
    const glm::dvec3 expected = glm::normalize(glm::cross(linear[2], linear[0]));
    EXPECT_LT(glm::distance(glm::normalize(normalMatrix(linear) * glm::dvec3(0, 1, 0)), expected), 1e-14);
  }
}

TEST(NormalMatrix, HasEntriesUpToOneAtAnyScaleAndNoneWithoutArea) {
  for (const double scale : {1e-38, 1e-20, 1.0, 1e38}) {
    const glm::mat3 matrix(normalMatrix(scale * kShear));
    EXPECT_TRUE(isFinite(matrix));
    EXPECT_NEAR(matrix[0][0], normalMatrix(kShear)[0][0], 1e-6) << scale;
  }
  EXPECT_EQ(normalMatrix(glm::dmat3(1, 0, 0, 0, 0, 0, 0, 0, 0)), glm::dmat3(0.0));
}

TEST(AreaMatrix, MapsAreaTimesNormal) {
  const glm::dvec3 a(1, 2, 0), b(0, 1, 3);
  EXPECT_LT(glm::distance(areaMatrix(kShear) * glm::cross(a, b), glm::cross(kShear * a, kShear * b)), 1e-12);
}

}  // namespace
}  // namespace lambent
