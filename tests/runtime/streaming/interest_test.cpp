#include <limits>
#include <numeric>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/streaming/parts.hpp"

namespace lambent::streaming {
namespace {

// Makes a bundle with surfaces of 100 bytes and one group, with codebooks of 20 and ten parts of planes of
// 10.
Parts smallParts() {
  Parts parts;
  parts.units = {{{.work = {}, .bytes = 100}}, {{.work = {}, .bytes = 20}}};
  for (int i = 0; i < 10; ++i) parts.units[1].push_back({.work = {}, .bytes = 10});
  return parts;
}

void chooseAmong(std::vector<Interest>& bundles, std::uint64_t max_bytes) {
  std::vector<Interest*> all;
  for (Interest& bundle : bundles) all.push_back(&bundle);
  choose(all, max_bytes);
}

struct Scene {
  std::vector<Interest> bundles;

  explicit Scene(const std::vector<float>& sizes, const Parts& parts = smallParts()) {
    for (const float size : sizes) bundles.push_back({parts, {size, size}, {0, 0}});
  }
  void choose(std::uint64_t max_bytes) { chooseAmong(bundles, max_bytes); }
  void see(const std::vector<float>& sizes) {
    for (std::size_t i = 0; i < sizes.size(); ++i) bundles[i].size = {sizes[i], sizes[i]};
  }
  std::uint64_t bytes() const {
    std::uint64_t sum = 0;
    for (const Interest& bundle : bundles)
      for (std::size_t u = 0; u < 2; ++u)
        for (std::uint32_t s = 0; s < bundle.target[u]; ++s) sum += bundle.parts.units[u][s].bytes;
    return sum;
  }
  std::vector<std::vector<std::uint32_t>> targets() const {
    std::vector<std::vector<std::uint32_t>> list;
    for (const Interest& bundle : bundles) list.push_back(bundle.target);
    return list;
  }
};

using Targets = std::vector<std::vector<std::uint32_t>>;

}  // namespace

TEST(Interest, TakesAllWhereThereIsRoomAndNeverMoreThanTheBudget) {
  const std::vector<float> sizes = {1.0f, 0.01f, 0.3f, 1e-9f};
  Scene all(sizes);
  all.choose(4 * 220);
  EXPECT_EQ(all.targets(), Targets(4, {1, 11}));
  for (std::uint64_t budget = 100; budget < 900; budget += 7) {
    Scene scene(sizes);
    scene.choose(budget);
    EXPECT_LE(scene.bytes(), budget);
    EXPECT_EQ(scene.bundles[0].target[0], 1u) << "the largest is always shown";
  }
}

TEST(Interest, LargerInSightComesFirstAndSurfacesBeforeShadowsBeforeDetail) {
  Scene scene({1.0f, 0.5f});
  scene.choose(250);
  EXPECT_EQ(scene.targets(), (Targets{{1, 2}, {1, 1}})) << "a share of planes to the larger one";
  Scene far({1.0f, 1e-3f});
  far.choose(250);
  EXPECT_EQ(far.targets(), (Targets{{1, 11}, {0, 0}})) << "planes of what is near before what is a dot";
}

TEST(Interest, ProxyLodsComeBeforeAnythingButTheLargestUpToAQuarterOfTheMemory) {
  const std::vector<float> sizes = {1e-4f, 1.0f, 0.5f, 1e-3f, 1e-2f, 1e-5f};
  Parts parts = smallParts();
  parts.units[0].insert(parts.units[0].begin(), Step{.work = {}, .bytes = 10});
  Scene scene(sizes, parts);
  scene.choose(400);
  for (const Interest& bundle : scene.bundles) EXPECT_GE(bundle.target[0], 1u);
  EXPECT_EQ(scene.bundles[1].target[0], 2u);
  EXPECT_EQ(scene.bundles[2].target[0], 2u) << "what is left goes by worth";
  EXPECT_LE(scene.bytes(), 400u);

  Scene tight(sizes, parts);
  tight.choose(135);
  EXPECT_EQ(tight.targets(), (Targets{{0, 0}, {2, 0}, {1, 0}, {0, 0}, {1, 0}, {0, 0}}))
      << "the largest, then the proxy levels of detail of those that are next";
  tight.choose(50);
  EXPECT_EQ(tight.targets(), (Targets{{0, 0}, {2, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}})) << "in any case";
}

TEST(Interest, TexturesHaveTheTexelsThatAreSeenAndNoMoreWhereOthersAskForMemory) {
  // Levels of 128 to 4096 texels a side over the 64 that come with the surfaces.
  Parts parts = smallParts();
  parts.images.push_back({.width = 4096, .height = 4096, .coarse = 6, .groups = {0}});
  parts.units.emplace_back();
  for (std::uint64_t bytes = 4; bytes <= 4096; bytes *= 4)
    parts.units.back().push_back({.work = {}, .bytes = bytes});
  const auto levels = [&](float size, std::uint64_t max_bytes) {
    std::vector<Interest> bundles(2, {parts, std::vector<float>(3, size), {0, 0, 0}});
    bundles[1].size.assign(3, 0.25f * size);  // half as large in the picture
    chooseAmong(bundles, max_bytes);
    return std::vector{bundles[0].target[2], bundles[1].target[2]};
  };
  EXPECT_EQ(levels(0.05f, 100'000), (std::vector{6u, 6u})) << "room for all";
  EXPECT_EQ(levels(0.05f, 2 * 220 + 2 * 84), (std::vector{3u, 3u})) << "512 texels: 514 pixels, and 257";
  EXPECT_EQ(levels(0.05f, 2 * 220 + 84 + 340), (std::vector{4u, 3u})) << "the nearer one first";
  const auto finest = [&](float size) { return worthOf(parts, 2, 5, size) / size; };
  EXPECT_LT(finest(0.01f), 0.25f * finest(0.1f)) << "texels smaller than pixels count for less";
  EXPECT_EQ(finest(4.0f), finest(16.0f)) << "larger ones all the same";
}

TEST(Interest, StaysUntilSomethingElseIsClearlyLarger) {
  Scene scene({1.0f, 1.0f, 0.9f});
  scene.choose(500);
  const Targets before = scene.targets();
  for (int i = 0; i < 20; ++i) {
    scene.see({1.0f, i % 2 == 0 ? 0.9f : 1.1f, i % 2 == 0 ? 1.1f : 0.9f});
    scene.choose(500);
    ASSERT_EQ(scene.targets(), before) << i;
  }
  scene.see({1.0f, 0.2f, 3.0f});
  scene.choose(500);
  EXPECT_NE(scene.targets(), before);
}

TEST(Interest, SizeIsByAngleAndLessBehindTheCamera) {
  spec::View view;
  view.eye_ws = {0.0f, 0.0f, 0.0f};
  view.clip_from_view = glm::perspective(0.8f, 1.5f, 0.1f, 1000.0f);
  const float near = sizeSeen(view, {0, 0, -11}, 1.0f), far = sizeSeen(view, {0, 0, -21}, 1.0f),
              behind = sizeSeen(view, {0, 0, 11}, 1.0f), inside = sizeSeen(view, {0, 0, 0.5f}, 1.0f);
  EXPECT_NEAR(near, 0.01f, 1e-5f);
  EXPECT_NEAR(far, 0.25f * near, 1e-5f);
  EXPECT_LT(behind, 0.2f * near);
  EXPECT_GT(inside, 10.0f);
}

// Sizes order what streams in, and NaN has no place in an order.
TEST(Interest, WhatHasNoPlaceCountsAsNear) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  spec::View view;
  view.clip_from_view = glm::perspective(0.8f, 1.5f, 0.1f, 1000.0f);
  const float inside = sizeSeen(view, glm::vec3(0.0f), 1.0f);
  EXPECT_EQ(sizeSeen(view, glm::vec3(nan), 1.0f), inside);
  EXPECT_EQ(sizeSeen(view, {0, 0, -11}, nan), inside);
}

}  // namespace lambent::streaming
