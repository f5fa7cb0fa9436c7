// Hits that are left out must not take light along, and cached hits must come back whole.
#include "baker/trace/hits.hpp"

#include <gtest/gtest.h>

#include "baker/trace/transfer_field.hpp"

namespace lambent::baker {

namespace {

std::vector<GatherHit> hitsOf(std::size_t count) {
  std::vector<GatherHit> hits;
  for (std::uint32_t h = 0; h < count; ++h)
    hits.push_back({.triangle = h % 7, .ray = 3 * h, .u = static_cast<std::uint16_t>(h), .v = 9});
  return hits;
}

double weightOf(std::uint32_t ray) {
  return 1.0 + 0.01 * ray;
}

TEST(KeepEvery, KeepsTheWeightOfAllHits) {
  const std::vector<GatherHit> hits = hitsOf(101);
  double all = 0.0;
  for (const GatherHit& hit : hits) all += weightOf(hit.ray);
  for (const std::uint32_t first : {0u, 1u, 3u}) {
    std::vector<GatherHit> kept;
    const float scale = keepEvery(4, first, hits, weightOf, kept);
    EXPECT_EQ(kept.size(), first == 0 ? 26u : 25u);
    EXPECT_EQ(kept.front().ray, 3 * first);
    double sum = 0.0;
    for (const GatherHit& hit : kept) sum += double{scale} * weightOf(hit.ray);
    EXPECT_NEAR(sum, all, 1e-5 * all);
  }
}

TEST(HitStore, GivesUpWholeRangesUntilFewEnoughBytesAreKept) {
  constexpr std::size_t kHits = 1000;
  HitStore store(4 * kSamplesPerRange, 3 * kHits * sizeof(GatherHit));
  for (std::size_t range = 0; range < 4; ++range) {
    RangeHits hits;
    hits.hits = hitsOf(kHits);
    store.offer(range, std::move(hits));
  }
  const std::size_t each = kHits * sizeof(GatherHit);
  EXPECT_EQ(store.bytes(), 3 * each) << "there is no room for the fourth";
  store.keepAtMost(3 * each);
  EXPECT_EQ(store.bytes(), 3 * each);
  store.keepAtMost(2 * each - 1);
  EXPECT_EQ(store.bytes(), each);
  EXPECT_TRUE(store.range(0).kept);
  for (std::size_t range = 1; range < 4; ++range) {
    EXPECT_FALSE(store.range(range).kept);
    EXPECT_TRUE(store.range(range).hits.empty());
  }
  store.keepAtMost(0);
  EXPECT_EQ(store.bytes(), 0u);
}

TEST(HitBytes, BringBackHitsAndTheirScales) {
  RangeHits hits;
  hits.next();
  hits.hits = hitsOf(5);
  hits.scales = {1.5f, 1.0f};
  hits.next();
  hits.next();
  for (GatherHit& hit : hits.hits) hit.setAlbedo(glm::vec3(1.0f));
  hits.hits[3].setAlbedo({0.25f, 0.5f, 0.75f});  // a pane before it
  ByteWriter out;
  writeHits(hits, out);
  const std::vector<std::byte> bytes = out.take();
  RangeHits found;
  ByteReader in(bytes);
  ASSERT_TRUE(readHits(in, 2, 7, found));
  EXPECT_EQ(found.offsets, hits.offsets);
  EXPECT_EQ(found.scales, hits.scales);
  ASSERT_EQ(found.hits.size(), 5u);
  EXPECT_EQ(found.hits[4].ray, 12u);
  for (std::size_t h = 0; h < 5; ++h) EXPECT_EQ(found.hits[h].albedoAt(), hits.hits[h].albedoAt());
  EXPECT_EQ(found.scaleOf(0), 1.5f);
  ByteReader again(bytes);
  EXPECT_FALSE(readHits(again, 3, 7, found)) << "a range of other samples";
}

TEST(FillFromNeighbours, GrowsInwardsLayerByLayer) {
  // 0 - 1 - 2 - 3 - 4 in a row, the ends valid: the middle is reached last, from both sides.
  std::vector<float> values = {1.0f, -9.0f, -9.0f, -9.0f, 5.0f};
  const std::vector<std::uint8_t> valid = {1, 0, 0, 0, 1};
  EXPECT_EQ(fillFromNeighbours({{0, 1}, {1, 2}, {2, 3}, {3, 4}}, valid, 0, 1, values), 3u);
  EXPECT_EQ(values, (std::vector<float>{1.0f, 1.0f, 3.0f, 5.0f, 5.0f}));
}

TEST(FillFromNeighbours, KeepsWhatNothingValidTouches) {
  std::vector<float> values = {1.0f, 2.0f, 3.0f};
  const std::vector<std::uint8_t> valid = {1, 0, 0};
  EXPECT_EQ(fillFromNeighbours({{1, 2}}, valid, 0, 1, values), 0u);
  EXPECT_EQ(values, (std::vector<float>{1.0f, 2.0f, 3.0f}));
}

}  // namespace
}  // namespace lambent::baker
