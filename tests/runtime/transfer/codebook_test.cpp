#include "runtime/transfer/codebook.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "runtime/bundle/container.hpp"

namespace lambent::transfer {
namespace {

std::vector<std::byte> prefix(const std::vector<std::byte>& bytes, std::size_t length) {
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)};
}

// Makes three clusters of 2, 1 and 0 axes over vectors of 4 values (order 1, one light, full in one channel).
TransferShape smallShape() {
  TransferShape shape;
  shape.order = 1;
  shape.light_columns = 1;
  shape.full_channels = 1;
  return shape;
}

Codebook smallCodebook() {
  Codebook codebook;
  codebook.axis_counts = {2, 1, 0};
  codebook.axes = {{-1.0f, 0.5f}, {0.0f, 0.25f}, {2.0f, 1.0f}};
  for (int i = 0; i < 6 * 4; ++i) codebook.vectors.push_back(static_cast<float>(i) * 0.125f - 1.0f);
  return codebook;
}

// Expects that a codebook that is cut short or goes on is refused.
void expectRefusedAtOtherLengths(std::vector<std::byte> bytes, std::uint32_t clusters) {
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(decodeCodebook(prefix(bytes, length), smallShape(), clusters, "cell 0")) << length;
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(decodeCodebook(bytes, smallShape(), clusters, "cell 0"));
}

// Returns how many flipped bits of a codebook are refused. Others must decode to finite vectors.
std::size_t refusedFlips(const std::vector<std::byte>& bytes, std::uint32_t clusters) {
  std::vector<std::uint32_t> cluster_of(clusters);
  std::iota(cluster_of.begin(), cluster_of.end(), 0u);
  std::size_t refused = 0;
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    auto flipped = bytes;
    flipped[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    const auto back = decodeCodebook(flipped, smallShape(), clusters, "cell 0");
    if (!back) {
      ++refused;
      continue;
    }
    std::vector<std::vector<std::uint32_t>> planes;
    for (const std::uint32_t count : planeCounts(*back, cluster_of)) planes.emplace_back(count, 65535u);
    for (const float value : decodeTransfer(smallShape(), *back, cluster_of, planes))
      EXPECT_TRUE(std::isfinite(value)) << bit;
  }
  return refused;
}

TEST(TransferShape, CountsBlocksChannelsOutputsAndColumns) {
  TransferShape shape;
  shape.order = 5;
  shape.light_columns = 2;
  shape.full_channels = 3;
  shape.outputs = 9;
  EXPECT_EQ(shape.columns(), 27u);
  EXPECT_EQ(shape.channels(), 4u);
  EXPECT_EQ(shape.size(), 4u * 9 * 27);
}

TEST(Codebook, ComesBackExactlyWhereHalfHoldsIt) {
  const Codebook codebook = smallCodebook();
  const auto bytes = encodeCodebook(codebook);
  EXPECT_EQ(bytes.size(), 4 + 3u * 2 + 3 * 8 + 24 * 2);
  const auto back = decodeCodebook(bytes, smallShape(), 3, "cell 0");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->axis_counts, codebook.axis_counts);
  EXPECT_EQ(back->vectors, codebook.vectors);
  ASSERT_EQ(back->axes.size(), codebook.axes.size());
  for (std::size_t a = 0; a < codebook.axes.size(); ++a) {
    EXPECT_EQ(back->axes[a].offset, codebook.axes[a].offset);
    EXPECT_EQ(back->axes[a].scale, codebook.axes[a].scale);
  }
}

TEST(Codebook, CutShortOrOfAnotherShapeIsRefused) {
  const auto bytes = encodeCodebook(smallCodebook());
  expectRefusedAtOtherLengths(bytes, 3);
  for (const std::uint32_t clusters : {0u, 1u, 2u, 4u, 1000u, 0xffffffffu})
    EXPECT_FALSE(decodeCodebook(bytes, smallShape(), clusters, "cell 0")) << clusters;
  TransferShape wider = smallShape();
  wider.order = 2;
  EXPECT_FALSE(decodeCodebook(bytes, wider, 3, "cell 0"));
  wider.order = 0;
  wider.light_columns = 0;  // vectors of no values
  EXPECT_FALSE(decodeCodebook(bytes, wider, 3, "cell 0"));
  const auto nothing = decodeCodebook({}, smallShape(), 3, "cell 7 of group lamp");
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().subject, "cell 7 of group lamp");
  EXPECT_FALSE(nothing.error().hint.empty());
}

TEST(Codebook, NumbersOfAxesThatRiseAreRefused) {
  Codebook codebook = smallCodebook();
  codebook.axis_counts = {1, 2, 0};  // as many bytes
  EXPECT_FALSE(decodeCodebook(encodeCodebook(codebook), smallShape(), 3, "cell 0"));
}

TEST(Codebook, WeightsAndValuesThatAreNotFiniteAreRefused) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  for (const float bad : {kInfinite, -kInfinite, std::numeric_limits<float>::quiet_NaN(), 3e38f}) {
    Codebook codebook = smallCodebook();
    codebook.axes[1].offset = bad;
    EXPECT_FALSE(decodeCodebook(encodeCodebook(codebook), smallShape(), 3, "cell 0")) << bad;
    codebook = smallCodebook();
    codebook.axes[2].scale = bad;
    EXPECT_FALSE(decodeCodebook(encodeCodebook(codebook), smallShape(), 3, "cell 0")) << bad;
    codebook = smallCodebook();
    codebook.vectors[9] = bad;  // 3e38 is infinite in half
    EXPECT_FALSE(decodeCodebook(encodeCodebook(codebook), smallShape(), 3, "cell 0")) << bad;
  }
}

TEST(Codebook, WithFlippedBitsIsRefusedOrDecodesToFiniteVectors) {
  EXPECT_GT(refusedFlips(encodeCodebook(smallCodebook()), 3), 3u * 16 / 2);  // most flips of a count
}

// Makes two basis vectors, and clusters of 1 and 0 axes over vectors of 4 values.
SharedCodebook sharedCodebook() {
  SharedCodebook codebook;
  codebook.axis_counts = {1, 0};
  codebook.axes = {{-1.0f, 0.5f}};
  codebook.value_scales = {1.0f, 1.0f, 2.0f, 0.5f};
  codebook.basis_scales = {0.25f, 1.0f};
  codebook.mean_scale = 0.5f;
  codebook.basis = {4, 0, -8, 1000, 0, -1, 1, 0};
  codebook.means = {2, 4, 0, -6};  // coordinate by coordinate
  codebook.directions = {-1, 3};
  return codebook;
}

TEST(SharedCodebook, ExpandsToMeansAndAxes) {
  const Codebook codebook = expand(sharedCodebook());
  // Basis: {1, 0, -4, 125} and {0, -1, 2, 0}.
  EXPECT_EQ(codebook.vectors, (std::vector<float>{1, 0, -4, 125,      // mean of cluster 0: 1 and 0
                                                  -1, -3, 10, -125,   // its axis: -1 and 3
                                                  2, 3, -14, 250}));  // mean of cluster 1: 2 and -3
  EXPECT_EQ(codebook.axis_counts, (std::vector<std::uint32_t>{1, 0}));
}

TEST(SharedCodebook, ComesBackExactly) {
  const SharedCodebook codebook = sharedCodebook();
  const auto bytes = encodeCodebook(codebook);
  const auto back = decodeCodebook(bytes, smallShape(), 2, "cell 0");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->vectors, expand(codebook).vectors);
  ASSERT_EQ(back->axes.size(), 1u);
  EXPECT_EQ(back->axes[0].offset, -1.0f);
  EXPECT_EQ(back->axes[0].scale, 0.5f);
  expectRefusedAtOtherLengths(bytes, 2);
  EXPECT_FALSE(decodeCodebook(bytes, smallShape(), 3, "cell 0"));
}

TEST(SharedCodebook, WithFlippedBitsIsRefusedOrDecodesToFiniteVectors) {
  EXPECT_GT(refusedFlips(encodeCodebook(sharedCodebook()), 2), 100u);
}

TEST(SharedCodebook, OfTooManyVectorsIsRefusedBeforeTheyAreMade) {
  // A payload of 140 kB claims to have 70,000 clusters of 3,072 values.
  SharedCodebook codebook;
  codebook.axis_counts.assign(70000, 0);
  TransferShape shape;
  shape.order = 8;
  shape.shadowed_channels = 3;
  shape.full_channels = 3;
  shape.outputs = 8;
  codebook.value_scales.assign(shape.size(), 1.0f);
  EXPECT_FALSE(decodeCodebook(encodeCodebook(codebook), shape, 70000, "cell 0"));
}

TEST(ClusterIds, ComeBackAtBothWidths) {
  for (const std::uint32_t clusters : {1u, 3u, 256u, 257u, 65536u}) {
    const std::vector<std::uint32_t> cluster_of = {0, clusters - 1, clusters / 2, 0, 0};
    const auto bytes = encodeClusterIds(cluster_of, clusters);
    EXPECT_EQ(bytes.size(), clusters <= 256 ? 5u : 10u);
    const auto back = decodeClusterIds(bytes, clusters, 5, "cell 0");
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(*back, cluster_of);
    for (std::size_t length = 0; length < bytes.size(); ++length)
      EXPECT_FALSE(decodeClusterIds(prefix(bytes, length), clusters, 5, "cell 0"));
    EXPECT_FALSE(decodeClusterIds(bytes, clusters, 6, "cell 0"));
    if (clusters > 1 && clusters != 257) {
      EXPECT_FALSE(decodeClusterIds(bytes, clusters - 1, 5, "cell 0"));
    }
  }
}

TEST(Positions, KeepTheCellsOrderWithinAClusterAndMakePlanesDense) {
  const std::vector<std::uint32_t> cluster_of = {2, 0, 1, 0, 2, 1, 0};
  EXPECT_EQ(positionsOf(cluster_of, 3), (std::vector<std::uint32_t>{1, 3, 6, 2, 5, 0, 4}));
  EXPECT_EQ(planeCounts(smallCodebook(), cluster_of), (std::vector<std::uint32_t>{5, 3}));
  EXPECT_TRUE(positionsOf({}, 3).empty());
}

TEST(WeightPlanes, ComeBackAtBothWidths) {
  for (const std::uint32_t bits : {8u, 16u}) {
    const std::vector<std::uint32_t> codes = {3, 0, 1, (1u << bits) - 1, 127, 128, (1u << bits) - 1, 0};
    const auto bytes = encodeWeightPlane(codes, bits);
    EXPECT_EQ(bytes.size(), codes.size() * bits / 8);
    const auto back = decodeWeightPlane(bytes, bits, 8, "cell 0");
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(*back, codes);
    for (std::size_t length = 0; length < bytes.size(); ++length)
      EXPECT_FALSE(decodeWeightPlane(prefix(bytes, length), bits, 8, "cell 0"));
    EXPECT_FALSE(decodeWeightPlane(bytes, bits, 7, "cell 0"));
  }
  EXPECT_TRUE(decodeWeightPlane({}, 8, 0, "cell 0")->empty());
  EXPECT_FALSE(decodeWeightPlane({}, 12, 0, "cell 0"));
}

TEST(WeightPlanes, HoldDifferencesNearZeroAsSmallBytes) {
  const auto bytes = encodeWeightPlane(std::vector<std::uint32_t>{3, 2, 2, 4, 0}, 8);
  EXPECT_EQ(bytes,
            (std::vector<std::byte>{std::byte{6}, std::byte{1}, std::byte{0}, std::byte{4}, std::byte{7}}));
}

TEST(ClusteredTransfer, DecodesMeanPlusWeightedAxesAndAnyPrefix) {
  TransferShape shape;
  shape.order = 1;
  shape.shadowed_channels = 3;
  Codebook codebook;
  codebook.axis_counts = {2, 0};
  codebook.axes = {{-1.0f, 0.5f}, {0.0f, 0.25f}};
  codebook.vectors = {1, 2, 3, 10, 20, 30, 100, 200, 300, 7, 8, 9};
  const std::vector<std::uint32_t> cluster_of = {1, 0, 0};
  const std::vector<std::vector<std::uint32_t>> planes = {{0, 4}, {1, 2}};
  EXPECT_EQ(decodeTransfer(shape, codebook, cluster_of, planes),
            (std::vector<float>{7, 8, 9, 1 - 10 + 25, 2 - 20 + 50, 3 - 30 + 75, 1 + 10 + 50, 2 + 20 + 100,
                                3 + 30 + 150}));
  EXPECT_EQ(decodeTransfer(shape, codebook, cluster_of, std::span(planes).first(1)),
            (std::vector<float>{7, 8, 9, 1 - 10, 2 - 20, 3 - 30, 1 + 10, 2 + 20, 3 + 30}));
  EXPECT_EQ(decodeTransfer(shape, codebook, cluster_of, {}), (std::vector<float>{7, 8, 9, 1, 2, 3, 1, 2, 3}));
}

TEST(VertexWeights, SingleRowsComeBackExactly) {
  VertexWeights rows{{0, 1, 2, 3}, {2, 0, 2}, {1.0f, 1.0f, 1.0f}};
  const auto bytes = encodeRows(rows);
  EXPECT_EQ(bytes.size(), 8u + 3 * 4);  // no offsets, no weights
  const auto back = decodeRows(bytes, 3, 3, "rows");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->offsets, rows.offsets);
  EXPECT_EQ(back->samples, rows.samples);
  EXPECT_EQ(back->weights, rows.weights);
}

TEST(VertexWeights, QuantizedWeightsStillSumToOne) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  VertexWeights rows;
  rows.offsets = {0};
  for (int v = 0; v < 200; ++v) {
    const int count = 1 + v % 4;
    std::vector<float> weights(static_cast<std::size_t>(count));
    for (float& w : weights) w = uniform(random);
    const float sum = std::accumulate(weights.begin(), weights.end(), 0.0f);
    for (int e = 0; e < count; ++e) {
      rows.samples.push_back(static_cast<std::uint32_t>((v + e) % 50));
      rows.weights.push_back(weights[static_cast<std::size_t>(e)] / sum);
    }
    rows.offsets.push_back(static_cast<std::uint32_t>(rows.samples.size()));
  }
  const auto back = decodeRows(encodeRows(rows), 200, 50, "rows");
  ASSERT_TRUE(back) << back.error().line();
  for (std::size_t v = 0; v < 200; ++v) {
    double sum = 0.0;
    for (std::uint32_t e = back->offsets[v]; e < back->offsets[v + 1]; ++e) {
      sum += double{back->weights[e]};
      // The tolerance is half a step of rounding, plus up to two for the weight that takes the remainder.
      EXPECT_NEAR(back->weights[e], rows.weights[e], 2.5f / 65535.0f);
    }
    EXPECT_NEAR(sum, 1.0, 1e-6);
  }
}

TEST(VertexWeights, DamagedOnesAreRefused) {
  VertexWeights rows{{0, 2, 3}, {0, 1, 1}, {0.5f, 0.5f, 1.0f}};
  const auto bytes = encodeRows(rows);
  ASSERT_TRUE(decodeRows(bytes, 2, 2, "rows"));
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(decodeRows(prefix(bytes, length), 2, 2, "rows")) << length;
  EXPECT_FALSE(decodeRows(bytes, 3, 2, "rows"));
  EXPECT_FALSE(decodeRows(bytes, 2, 1, "rows"));  // sample 1 of 1
  auto falling = bytes;
  falling[8 + 4] = std::byte{9};  // offsets {0, 9, 3}
  EXPECT_FALSE(decodeRows(falling, 2, 2, "rows"));
  for (const int kind : {0, 1, 4}) {  // 0 and 1 held samples, not differences
    auto other = bytes;
    other[0] = static_cast<std::byte>(kind);
    EXPECT_FALSE(decodeRows(other, 2, 2, "rows")) << kind;
  }
}

TEST(VertexWeights, SamplesInOrderCostNextToNothing) {
  VertexWeights rows{{0}, {}, {}};
  for (std::uint32_t v = 0; v < 10000; ++v) {
    rows.offsets.push_back(v + 1);
    rows.samples.push_back(70000 + v);
    rows.weights.push_back(1.0f);
  }
  const auto bytes = encodeRows(rows);
  EXPECT_LT(bundle::compressZstd(bytes, 9).size(), 100u) << "one difference, 9999 times";
  EXPECT_EQ(decodeRows(bytes, 10000, 80000, "rows")->samples, rows.samples);
}

TEST(VertexWeights, DifferencesGoBackwardsAndFar) {
  const VertexWeights rows{{0, 1, 2, 3, 4}, {5, 0, 0xfffffff0u, 3}, {1.0f, 1.0f, 1.0f, 1.0f}};
  const auto back = decodeRows(encodeRows(rows), 4, 0xffffffffu, "rows");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->samples, rows.samples);
}

const std::vector<LightWeights> kThree = {
    kOneLight, {{2, 0, 1, 3}, {100, 80, 50, 25}}, {{3, 1, 0, 0}, {128, 127, 0, 0}}};

TEST(LightWeights, ComeBackExactlyInEightBytesASample) {
  const auto bytes = encodeLightWeights(kThree);
  EXPECT_EQ(bytes.size(), 3u * 8);
  EXPECT_EQ(bytes[1], std::byte{2}) << "runs of one number: light 0 of sample 1 stands second";
  const auto back = decodeLightWeights(bytes, 3, 4, "cell 0");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(*back, kThree);
  EXPECT_TRUE(decodeLightWeights({}, 0, 1, "cell 0"));
}

TEST(LightWeights, OfAnotherLengthOrPastTheListAreRefused) {
  const auto bytes = encodeLightWeights(kThree);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(decodeLightWeights(std::span(bytes).first(length), 3, 4, "cell 0")) << length;
  EXPECT_FALSE(decodeLightWeights(bytes, 2, 4, "cell 0"));
  EXPECT_FALSE(decodeLightWeights(bytes, 4, 4, "cell 0"));
  EXPECT_FALSE(decodeLightWeights(bytes, 3, 3, "cell 0")) << "light probe 3 of 3";
}

TEST(LightWeights, ThatDoNotSumToAWholeAreRefused) {
  auto bytes = encodeLightWeights(kThree);
  for (std::size_t i = 4 * 3; i < bytes.size(); ++i) {
    auto other = bytes;
    other[i] ^= std::byte{1};
    const auto read = decodeLightWeights(other, 3, 4, "cell 0");
    ASSERT_FALSE(read) << i;
    EXPECT_EQ(read.error().subject, "cell 0");
  }
}

TEST(Zstd, RefusesAFalseLength) {
  const std::vector<std::byte> bytes(1000, std::byte{42});
  const auto packed = bundle::compressZstd(bytes, 3);
  EXPECT_EQ(*bundle::decompressZstd(packed, 1000, "payload"), bytes);
  EXPECT_FALSE(bundle::decompressZstd(packed, 999, "payload"));
  EXPECT_FALSE(bundle::decompressZstd(packed, std::size_t{1} << 40, "payload"));
  EXPECT_FALSE(bundle::decompressZstd(std::span(packed).first(packed.size() / 2), 1000, "payload"));
  EXPECT_FALSE(bundle::decompressZstd({}, 0, "payload"));
}

}  // namespace
}  // namespace lambent::transfer
