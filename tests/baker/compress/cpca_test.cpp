#include "baker/compress/cpca.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/jobs/parallel.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {
namespace {

transfer::TransferShape shapeOf(std::uint32_t order, std::uint32_t shadowed = 1, std::uint32_t full = 0,
                                std::uint32_t outputs = 1, std::uint32_t lights = 0) {
  transfer::TransferShape shape;
  shape.order = order;
  shape.light_columns = lights;
  shape.shadowed_channels = shadowed;
  shape.full_channels = full;
  shape.outputs = outputs;
  return shape;
}

// Makes the transfer of a bumpy world: unoccluded vectors along a path of normals, with each run of `columns`
// values attenuated and disturbed differently.
std::vector<float> bumpyTransfer(std::size_t count, const transfer::TransferShape& shape, unsigned seed,
                                 float noise = 0.01f) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> vectors(count * shape.size()), open(std::size_t{shape.order} * shape.order);
  glm::vec3 direction(0, 0, 1);
  for (std::size_t s = 0; s < count; ++s) {
    direction += 0.4f * glm::vec3(normal(random), normal(random), normal(random));
    direction = glm::normalize(direction);
    if (shape.order > 0) sh::unoccludedTransfer(static_cast<int>(shape.order), direction, open);
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const std::size_t column = i % shape.columns();
      const float value = column < open.size() ? open[column] : 0.3f + 0.2f * direction.x;
      const float dim = 0.7f + 0.1f * static_cast<float>(i / shape.columns() % 3);
      vectors[s * shape.size() + i] = dim * value + noise * normal(random);
    }
  }
  return vectors;
}

std::vector<float> decoded(const CodedTransfer& coded, std::size_t planes = 1000) {
  std::vector<std::vector<std::uint32_t>> codes;
  for (const CodedPlane& plane : coded.planes)
    if (codes.size() < planes) codes.push_back(plane.codes);
  return transfer::decodeTransfer(coded.shape, transfer::expand(coded.codebook), coded.cluster_of, codes);
}

std::size_t codesOf(const CodedTransfer& coded) {
  std::size_t codes = 0;
  for (const CodedPlane& plane : coded.planes) codes += plane.codes.size();
  return codes;
}

CodedTransfer code(const std::vector<float>& vectors, const transfer::TransferShape& shape, float bound,
                   std::uint32_t clusters = 0) {
  return codeTransfer(vectors, vectors.size() / shape.size(), shape, {bound, clusters});
}

void expectSound(const CodedTransfer& coded, std::size_t count) {
  ASSERT_EQ(coded.cluster_of.size(), count);
  const transfer::Codebook book = transfer::expand(coded.codebook);
  const auto counts = transfer::planeCounts(book, coded.cluster_of);
  ASSERT_EQ(counts.size(), coded.planes.size());
  for (std::size_t j = 0; j < counts.size(); ++j) EXPECT_EQ(coded.planes[j].codes.size(), counts[j]);
  for (std::size_t j = 1; j < counts.size(); ++j)
    EXPECT_LE(coded.planes[j].variance, coded.planes[j - 1].variance);
  for (const float value : decoded(coded)) ASSERT_TRUE(std::isfinite(value));
  EXPECT_TRUE(std::isfinite(coded.error));
  const auto bytes = transfer::encodeCodebook(coded.codebook);
  const auto back =
      transfer::decodeCodebook(bytes, coded.shape, static_cast<std::uint32_t>(book.clusters()), "cell");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->vectors, book.vectors);
}

TEST(Cpca, KeepsItsBoundForFewSamplesThatFaceWhereNoOthersDo) {
  // Most of a room's samples lie in a few dimensions. A basis that is found from some of them misses the
  // rest.
  const transfer::TransferShape shape = shapeOf(5);
  constexpr std::size_t kCount = 40'000, kRare = 64;
  std::vector<float> up(shape.size()), aside(shape.size());
  sh::unoccludedTransfer(5, glm::vec3(0, 1, 0), up);
  sh::unoccludedTransfer(5, glm::normalize(glm::vec3(1, -0.5f, 0.7f)), aside);
  for (std::size_t first = 0; first + kRare < kCount; first += kCount / 12) {
    std::vector<float> vectors;
    for (std::size_t s = 0; s < kCount; ++s) {
      const bool rare = s >= first && s < first + kRare;
      const float dim = 0.5f + 0.5f * static_cast<float>(s % 97) / 97.0f;
      for (std::size_t i = 0; i < shape.size(); ++i) vectors.push_back(dim * (rare ? aside[i] : up[i]));
    }
    const CodedTransfer coded = codeTransfer(vectors, kCount, shape, {.bound = 0.005f});
    EXPECT_LE(coded.error, 0.005f) << "rare samples from " << first;
  }
}

TEST(ClusteredCoding, KeepsItsBoundAtEveryOrderOnWhatTheFileDecodesTo) {
  for (const std::uint32_t order : {1u, 2u, 5u, 8u})
    for (const float bound : {0.03f, 0.003f, 0.0005f}) {
      const auto shape = shapeOf(order);
      const auto vectors = bumpyTransfer(700, shape, 3);
      const CodedTransfer coded = code(vectors, shape, bound);
      expectSound(coded, 700);
      EXPECT_LE(coded.error, bound) << order;
      EXPECT_NEAR(radianceError(vectors, decoded(coded), shape), double{coded.error}, 1e-7);
    }
}

TEST(ClusteredCoding, KeepsItsBoundForBothBlocksEachByItself) {
  for (const auto& shape : {shapeOf(5, 1, 3), shapeOf(4, 3, 3), shapeOf(3, 1, 1), shapeOf(2, 1, 3, 9)}) {
    const auto vectors = bumpyTransfer(500, shape, 5);
    const CodedTransfer coded = code(vectors, shape, 0.004f);
    expectSound(coded, 500);
    EXPECT_LE(coded.error, 0.004f);
    EXPECT_GT(coded.error, 0.003f);  // the bound is used
  }
}

TEST(ClusteredCoding, TakesLightsOfTheGroupFromVeryFarAndVeryNear) {
  const auto shape = shapeOf(3, 1, 3, 1, 2);
  auto vectors = bumpyTransfer(400, shape, 7);
  for (std::size_t at = 0; at < vectors.size(); ++at) {
    if (at % 11 == 9) vectors[at] *= 1e-7f;
    if (at % 11 == 10) vectors[at] *= 1e7f;  // beyond what half precision holds
  }
  const CodedTransfer coded = code(vectors, shape, 0.005f);
  expectSound(coded, 400);
  EXPECT_LE(coded.error, 0.005f);
  // Each light counts like the environment: a distant lamp alone is coded as well as everything.
  const auto back = decoded(coded);
  double off = 0.0, energy = 0.0;
  for (std::size_t at = 9; at < vectors.size(); at += 11) {
    off += std::pow(double{back[at]} - double{vectors[at]}, 2);
    energy += std::pow(double{vectors[at]}, 2);
  }
  EXPECT_LE(std::sqrt(off / energy),
            std::sqrt(3.0) * 0.005 * 1.5);  // a third of the energy, and not all alike
}

// One sample of 7,001 is ten thousand times as bright as the others. Which cluster it lands in is up to
// chance, and codes of 16 bits do not span it and the dark samples together.
TEST(ClusteredCoding, OfLampsKnowsTheFewSamplesNextToThem) {
  const auto shape = shapeOf(0, 1, 0, 25, 1);
  const std::size_t count = 60'000;
  std::vector<float> vectors(count * shape.size());
  for (const unsigned seed : {21u, 26u, 27u, 33u}) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    for (std::size_t s = 0; s < count; ++s)
      for (std::size_t i = 0; i < shape.size(); ++i)
        vectors[s * shape.size() + i] = s % 7'001 == 5'000 ? normal(random)
                                        : i == s % 3       ? 1e-4f * normal(random)
                                                           : 0.0f;
    const CodedTransfer coded = code(vectors, shape, 0.003f);
    expectSound(coded, count);
    EXPECT_LE(coded.error, 0.003f) << "random numbers from " << seed;
  }
}

TEST(ClusteredCoding, OfADarkRoomWithABrightSillKnowsTheRoom) {
  const auto shape = shapeOf(5);
  constexpr float kBound = 0.005f;
  auto vectors = bumpyTransfer(2000, shape, 15);
  for (std::size_t s = 0; s < 200; ++s)
    for (std::size_t i = 0; i < shape.size(); ++i) vectors[s * shape.size() + i] *= 100.0f;
  const auto back = decoded(code(vectors, shape, kBound));
  const auto first = static_cast<std::ptrdiff_t>(200 * shape.size());
  const std::vector<float> room(vectors.begin() + first, vectors.end()),
      coded(back.begin() + first, back.end());
  // Errors spread evenly would be kBound times the RMS of all, which is 32 times what the room has.
  EXPECT_LT(radianceError(room, coded, shape), 5.0 * double{kBound});
}

TEST(ClusteredCoding, AnyPrefixRendersAndMoreIsBetter) {
  const auto shape = shapeOf(5, 1, 3);
  const auto vectors = bumpyTransfer(900, shape, 9);
  for (const std::uint32_t clusters : {1u, 6u}) {
    const CodedTransfer coded = code(vectors, shape, 0.003f, clusters);
    ASSERT_GT(coded.planes.size(), 5u);
    double before = 1e9;
    for (std::size_t planes = 0; planes <= coded.planes.size(); ++planes) {
      const double error = radianceError(vectors, decoded(coded, planes), shape);
      EXPECT_LE(error, before * 1.0001) << planes;  // the last planes carry little more than rounding
      before = error;
    }
  }
}

TEST(ClusteredCoding, OneClusterIsPrincipalComponents) {
  const auto shape = shapeOf(5);
  const auto vectors = bumpyTransfer(600, shape, 11);
  const CodedTransfer coded = code(vectors, shape, 0.003f, 1);
  EXPECT_EQ(coded.codebook.clusters(), 1u);
  const transfer::Codebook book = transfer::expand(coded.codebook);
  for (std::size_t i = 0; i < 25; ++i) {
    double mean = 0.0;
    for (std::size_t s = 0; s < 600; ++s) mean += double{vectors[s * 25 + i]} / 600.0;
    // The values are quantized; the tolerance is well below the allowed error.
    EXPECT_NEAR(book.vectors[i], mean, 1e-3);
  }
  // The variance along the first axis is large.
  ASSERT_GT(coded.planes.size(), 3u);
  EXPECT_GT(coded.planes[0].variance, 0.2f);
}

TEST(ClusteredCoding, FindsTheClustersOfAWorldThatHasSome) {
  // The samples have eight directions and little noise: each of eight points has one line about it.
  const auto shape = shapeOf(5);
  std::mt19937 random(13);
  std::normal_distribution<float> normal;
  std::vector<float> vectors(4096 * 25);
  for (std::size_t s = 0; s < 4096; ++s) {
    const auto own = std::span(vectors).subspan(s * 25, 25);
    const float angle = static_cast<float>(s / 64 % 8) * 0.785f;
    sh::unoccludedTransfer(5, glm::vec3(std::cos(angle), std::sin(angle), 0.0f), own);
    const float dim = 1.0f + 0.05f * normal(random);
    for (float& value : own) value *= dim;
  }
  const CodedTransfer free = code(vectors, shape, 0.002f), single = code(vectors, shape, 0.002f, 1);
  expectSound(free, 4096);
  EXPECT_LE(free.error, 0.002f);
  EXPECT_GE(free.codebook.clusters(), 4u);
  EXPECT_LT(2 * codesOf(free), codesOf(single));
}

TEST(ClusteredCoding, StandsFewSamplesAndDuplicates) {
  const auto shape = shapeOf(5, 1, 3);
  for (const std::size_t count : {1u, 2u, 3u, 7u, 30u})
    for (const std::uint32_t clusters : {0u, 1u, 5u, 64u}) {  // more clusters than samples, too
      auto vectors = bumpyTransfer(count, shape, 17);
      for (const bool doubled : {false, true}) {
        if (doubled)
          vectors.insert(vectors.end(), vectors.begin(),
                         vectors.begin() + static_cast<std::ptrdiff_t>(vectors.size()));
        const CodedTransfer coded = code(vectors, shape, 0.003f, clusters);
        expectSound(coded, vectors.size() / shape.size());
        EXPECT_LE(coded.error, 0.003f) << count << " samples, " << clusters << " clusters";
      }
    }
}

TEST(ClusteredCoding, OfDarknessIsDark) {
  const auto shape = shapeOf(5, 1, 3, 1, 2);
  const std::vector<float> vectors(30 * shape.size(), 0.0f);
  const CodedTransfer coded = code(vectors, shape, 0.003f);
  expectSound(coded, 30);
  EXPECT_EQ(coded.error, 0.0f);
  EXPECT_EQ(decoded(coded), vectors);
}

TEST(ClusteredCoding, OfDarknessInOneBlockOrColumnKeepsIt) {
  const auto shape = shapeOf(3, 1, 3, 1, 1);
  auto vectors = bumpyTransfer(200, shape, 19);
  for (std::size_t at = 0; at < vectors.size(); ++at)
    if (at % shape.size() < 10 || at % 10 == 9) vectors[at] = 0.0f;  // shadowed block; the light
  const CodedTransfer coded = code(vectors, shape, 0.003f);
  expectSound(coded, 200);
  EXPECT_LE(coded.error, 0.003f);
  const auto back = decoded(coded);
  for (std::size_t at = 0; at < vectors.size(); ++at) {
    if (at % shape.size() < 10 || at % 10 == 9) {
      EXPECT_EQ(back[at], 0.0f);
    }
  }
}

TEST(ClusteredCoding, StopsWhenAskedTo) {
  const auto shape = shapeOf(5);
  const auto vectors = bumpyTransfer(2000, shape, 37);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_TRUE(codeTransfer(vectors, 2000, shape, {0.005f, 0}, stop.get_token()).cluster_of.empty());
}

TEST(RadianceError, IsRelativeToTheBlockAndTakesTheWorse) {
  const auto shape = shapeOf(1, 1, 3);  // one shadowed value, three full ones
  const std::vector<float> truth = {1, 2, 2, 2, 1, 2, 2, 2};
  std::vector<float> coded = truth;
  coded[0] += 0.1f;  // of an energy of 2
  EXPECT_NEAR(radianceError(truth, coded, shape), 0.1 / std::sqrt(2.0), 1e-6);
  coded[1] += 1.2f;  // of an energy of 24
  EXPECT_NEAR(radianceError(truth, coded, shape), 1.2 / std::sqrt(24.0), 1e-6);
  EXPECT_EQ(radianceError(truth, truth, shape), 0.0);
}

TEST(RadianceError, OfWhatIsNotANumberIsNone) {
  const auto shape = shapeOf(1, 1, 3);
  std::vector<float> truth = {1, 2, 2, 2, 1, 2, 2, 2}, coded = truth;
  truth[0] = std::numeric_limits<float>::quiet_NaN();  // of the first block; the second errs
  coded[1] += 1.2f;
  EXPECT_TRUE(std::isnan(radianceError(truth, coded, shape)));
}

TEST(RadianceError, WeighsBandsAsLightDoes) {
  const auto shape = shapeOf(2);
  std::vector<float> truth(4, 0.0f), coded(4, 0.0f);
  truth[0] = 1.0f;
  coded = truth;
  coded[2] = 0.1f;  // band 1, which carries 0.5085 of band 0's power (cpca.hpp)
  EXPECT_NEAR(radianceError(truth, coded, shape), 0.1 * std::sqrt(0.5085), 1e-6);
}

}  // namespace
}  // namespace lambent::baker
