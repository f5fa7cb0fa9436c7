#include "runtime/bundle/transfer_codec.hpp"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace lambent::bundle {
namespace {

TEST(VertexRows, SingleRowsComeBackExactly) {
  VertexRows rows{{0, 1, 2, 3}, {2, 0, 2}, {1.0f, 1.0f, 1.0f}};
  const auto bytes = encodeRows(rows);
  EXPECT_EQ(bytes.size(), 8u + 3 * 4);  // no offsets, no weights
  const auto back = decodeRows(bytes, 3, 3, "rows");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->offsets, rows.offsets);
  EXPECT_EQ(back->samples, rows.samples);
  EXPECT_EQ(back->weights, rows.weights);
}

TEST(VertexRows, QuantizedWeightsStillSumToOne) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  VertexRows rows;
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
      // Half a step of rounding, and up to four of them where the remainder went.
      EXPECT_NEAR(back->weights[e], rows.weights[e], 2.5f / 65535.0f);
    }
    EXPECT_NEAR(sum, 1.0, 1e-6);
  }
}

TEST(VertexRows, DamagedOnesAreRefused) {
  VertexRows rows{{0, 2, 3}, {0, 1, 1}, {0.5f, 0.5f, 1.0f}};
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
}

TEST(TransferBasis, HalfKeepsElevenBits) {
  std::vector<float> values;
  for (int i = -300; i <= 300; ++i) values.push_back(0.0031f * static_cast<float>(i));
  const auto back = decodeBasis(encodeBasis(values), values.size(), "basis");
  ASSERT_TRUE(back);
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_NEAR((*back)[i], values[i], std::max(std::abs(values[i]) / 2048.0f, 1e-7f));
  EXPECT_FALSE(decodeBasis(encodeBasis(values), values.size() + 1, "basis"));
  const std::vector<std::byte> infinite = {std::byte{0x00}, std::byte{0x7c}};
  EXPECT_FALSE(decodeBasis(infinite, 1, "basis"));
}

TEST(WeightPlane, CodesComeBackAtBothWidths) {
  for (const std::uint32_t bits : {8u, 16u}) {
    const std::vector<std::uint32_t> codes = {0, 1, 127, 128, (1u << bits) - 1};
    const auto bytes = encodePlane(codes, bits);
    EXPECT_EQ(bytes.size(), codes.size() * bits / 8);
    const auto back = decodePlane(bytes, bits, 5, "plane");
    ASSERT_TRUE(back);
    EXPECT_EQ(*back, codes);
    EXPECT_FALSE(decodePlane(bytes, bits, 6, "plane"));
  }
}

TEST(TransferCodec, DecodesMeanPlusWeightedAxesAndAnyPrefix) {
  DiffuseTransfer transfer;
  transfer.order = 1;
  transfer.channels = 3;
  transfer.planes = {{0, 8, -1.0f, 0.5f, 0.9f}, {0, 8, 0.0f, 0.25f, 0.1f}};
  const std::vector<float> basis = {1, 2, 3, 10, 20, 30, 100, 200, 300};
  const std::vector<std::vector<std::uint32_t>> planes = {{0, 4}, {1, 2}};
  const auto both = decodeTransfer(transfer, 2, basis, planes);
  EXPECT_EQ(both, (std::vector<float>{1 - 10 + 25, 2 - 20 + 50, 3 - 30 + 75, 1 + 10 + 50, 2 + 20 + 100,
                                      3 + 30 + 150}));
  const auto mean = decodeTransfer(transfer, 2, basis, {});
  EXPECT_EQ(mean, (std::vector<float>{1, 2, 3, 1, 2, 3}));
}

TEST(Zstd, RefusesAFalseLength) {
  const std::vector<std::byte> bytes(1000, std::byte{42});
  const auto packed = compressZstd(bytes, 3);
  EXPECT_EQ(*decompressZstd(packed, 1000, "payload"), bytes);
  EXPECT_FALSE(decompressZstd(packed, 999, "payload"));
  EXPECT_FALSE(decompressZstd(packed, std::size_t{1} << 40, "payload"));
  EXPECT_FALSE(decompressZstd(std::span(packed).first(packed.size() / 2), 1000, "payload"));
  EXPECT_FALSE(decompressZstd({}, 0, "payload"));
}

}  // namespace
}  // namespace lambent::bundle
