#include <gtest/gtest.h>

#include "runtime/transfer/codebook.hpp"

namespace lambent::transfer {
namespace {

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

}  // namespace
}  // namespace lambent::transfer
