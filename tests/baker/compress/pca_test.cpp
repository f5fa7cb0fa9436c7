#include "baker/compress/pca.hpp"

#include <cmath>
#include <numeric>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {
namespace {

// Transfer of a bumpy world: unoccluded vectors of random normals, dimmed and disturbed.
std::vector<float> bumpyTransfer(std::size_t count, int order, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> vectors(count * static_cast<std::size_t>(order * order));
  for (std::size_t s = 0; s < count; ++s) {
    const auto own = std::span(vectors).subspan(s * static_cast<std::size_t>(order * order),
                                                static_cast<std::size_t>(order * order));
    sh::unoccludedTransfer(order, glm::normalize(glm::vec3(normal(random), normal(random), normal(random))),
                           own);
    for (float& value : own) value = 0.7f * value + 0.01f * normal(random);
  }
  return vectors;
}

std::vector<float> decoded(const CodedTransfer& coded, std::size_t planes) {
  std::vector<std::vector<std::uint32_t>> codes;
  for (const CodedPlane& plane : coded.planes)
    if (codes.size() < planes) codes.push_back(plane.codes);
  return bundle::decodeTransfer(coded.shape, coded.codebook, coded.cluster_of, codes);
}

TEST(TransferCoding, KeepsItsErrorBoundAtEveryOrder) {
  for (const int order : {1, 2, 3, 5, 8})
    for (const float bound : {0.03f, 0.003f, 0.001f}) {
      const auto vectors = bumpyTransfer(700, order, 3);
      const CodedTransfer coded = codeTransfer(vectors, 700, order, 1, bound);
      EXPECT_LE(coded.error, bound);
      EXPECT_NEAR(radianceError(vectors, decoded(coded, coded.planes.size()), order, 1), coded.error, 1e-6);
    }
}

TEST(TransferCoding, KeepsItsErrorBoundForThreeChannels) {
  const auto vectors = bumpyTransfer(900, 4, 5);  // 300 samples of 3 x 16
  EXPECT_LE(codeTransfer(vectors, 300, 4, 3, 0.003f).error, 0.003f);
}

TEST(TransferCoding, AnyPrefixRendersAndMoreIsBetter) {
  const auto vectors = bumpyTransfer(500, 5, 9);
  const CodedTransfer coded = codeTransfer(vectors, 500, 5, 1, 0.003f);
  ASSERT_GT(coded.planes.size(), 5u);
  double before = 1e9;
  for (std::size_t planes = 0; planes <= coded.planes.size(); ++planes) {
    const double error = radianceError(vectors, decoded(coded, planes), 5, 1);
    EXPECT_LT(error, before) << planes;
    before = error;
  }
  for (std::size_t j = 1; j < coded.planes.size(); ++j)
    EXPECT_LE(coded.planes[j].variance, coded.planes[j - 1].variance);
}

TEST(TransferCoding, OfEqualVectorsNeedsNoPlane) {
  std::vector<float> vectors(40 * 25);
  for (std::size_t s = 0; s < 40; ++s)
    sh::unoccludedTransfer(5, glm::vec3(0, 1, 0), std::span(vectors).subspan(s * 25, 25));
  const CodedTransfer coded = codeTransfer(vectors, 40, 5, 1, 0.003f);
  EXPECT_EQ(coded.planes.size(), 0u);
  EXPECT_LE(coded.error, 0.003f);
}

TEST(TransferCoding, StandsFewerSamplesThanCoefficients) {
  for (const std::size_t count : {1u, 2u, 7u}) {
    const auto vectors = bumpyTransfer(count, 5, 17);
    const CodedTransfer coded = codeTransfer(vectors, count, 5, 1, 0.003f);
    EXPECT_LE(coded.error, 0.003f);
    EXPECT_LT(coded.planes.size(), std::max<std::size_t>(count, 1));
  }
}

TEST(TransferCoding, OfDarknessIsDark) {
  const std::vector<float> vectors(30 * 25, 0.0f);
  const CodedTransfer coded = codeTransfer(vectors, 30, 5, 1, 0.003f);
  EXPECT_EQ(coded.error, 0.0f);
  EXPECT_EQ(decoded(coded, coded.planes.size()), vectors);
}

TEST(TransferCoding, IsTheSameTwice) {
  const auto vectors = bumpyTransfer(400, 5, 21);
  const CodedTransfer a = codeTransfer(vectors, 400, 5, 1, 0.003f),
                      b = codeTransfer(vectors, 400, 5, 1, 0.003f);
  EXPECT_EQ(a.codebook.vectors, b.codebook.vectors);
  ASSERT_EQ(a.planes.size(), b.planes.size());
  for (std::size_t j = 0; j < a.planes.size(); ++j) EXPECT_EQ(a.planes[j].codes, b.planes[j].codes);
}

}  // namespace
}  // namespace lambent::baker
