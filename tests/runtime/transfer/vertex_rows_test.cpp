#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "runtime/bundle/container.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::transfer {
namespace {

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
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const std::vector<std::byte> prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_FALSE(decodeRows(prefix, 2, 2, "rows")) << length;
  }
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
