#include "runtime/bundle/capture_proxy.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace lambent::bundle {
namespace {

// Makes two levels: the first has a lamp's panel, the second one grey triangle.
CaptureProxy smallProxy() {
  CaptureProxy proxy;
  proxy.positions = {{0.1f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, -3e8f}, {1.0f, 1.0f, 0.25f}};
  proxy.triangles = {{{0, 1, 2}, true, {3.0f, 2.5f, 0.0f}, 1, 0, 0},
                     {{1, 3, 2}, false, glm::vec3(0.0f), -1, 0, 2},
                     {{0, 1, 3}, false, glm::vec3(0.0f), -1, 2, 1}};
  proxy.entries = {{7, {0.25f, 0.5f, 0.0f}}, {2, {0.75f, 0.5f, 0.0f}}, {9, glm::vec3(1.0f)}};
  proxy.levels = {{0, 2, 0.001f}, {2, 1, 0.5f}};
  return proxy;
}

// Makes the same with a surface for its own parts.
CaptureProxy withPatches() {
  CaptureProxy proxy = smallProxy();
  proxy.patches.positions = {
      {0.5f, 0.0f, 0.0f}, {1.0f, -2e7f, 0.0f}, {0.0f, 1.0f, 0.125f}, {2.0f, 1.0f, 1.0f}};
  proxy.patches.triangles = {{{0, 1, 2}, true, {0.2f, 0.4f, 1.0f}}, {{1, 3, 2}, false, {0.0f, 0.6f, 0.8f}}};
  proxy.patches.error_m = 0.25f;
  return proxy;
}

auto decode(const std::vector<std::byte>& bytes, std::uint32_t samples = 10, std::uint32_t lights = 2) {
  return decodeCaptureProxy(bytes, samples, lights, "group 0");
}

TEST(CaptureProxy, ComesBackExactlyButForStepsOfReflectance) {
  const CaptureProxy proxy = smallProxy();
  const auto back = decode(encodeCaptureProxy(proxy));
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->positions, proxy.positions);
  ASSERT_EQ(back->triangles.size(), 3u);
  for (std::size_t t = 0; t < 3; ++t) {
    const ProxyTriangle &found = back->triangles[t], &wanted = proxy.triangles[t];
    EXPECT_EQ(found.vertices, wanted.vertices);
    EXPECT_EQ(found.front_only, wanted.front_only);
    EXPECT_EQ(found.emission, wanted.emission);
    EXPECT_EQ(found.light, wanted.light);
    EXPECT_EQ(found.first_entry, wanted.first_entry);
    EXPECT_EQ(found.entry_count, wanted.entry_count);
  }
  ASSERT_EQ(back->entries.size(), 3u);
  for (std::size_t e = 0; e < 3; ++e) {
    EXPECT_EQ(back->entries[e].sample, proxy.entries[e].sample);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(back->entries[e].reflectance[c], proxy.entries[e].reflectance[c], 0.6f / 65535.0f);
  }
  ASSERT_EQ(back->levels.size(), 2u);
  EXPECT_EQ(back->levels[1].first_triangle, 2u);
  EXPECT_EQ(back->levels[1].triangle_count, 1u);
  EXPECT_EQ(back->levels[1].error_m, 0.5f);
}

TEST(CaptureProxy, BringsTheSurfaceForItsOwnPartsInStepsOfAByteOfAlbedo) {
  const CaptureProxy proxy = withPatches();
  const auto back = decode(encodeCaptureProxy(proxy));
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->patches.positions, proxy.patches.positions);
  EXPECT_EQ(back->patches.error_m, 0.25f);
  ASSERT_EQ(back->patches.triangles.size(), 2u);
  for (std::size_t t = 0; t < 2; ++t) {
    const PatchTriangle &found = back->patches.triangles[t], &wanted = proxy.patches.triangles[t];
    EXPECT_EQ(found.vertices, wanted.vertices);
    EXPECT_EQ(found.front_only, wanted.front_only);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.albedo[c], wanted.albedo[c], 0.6f / 255.0f);
  }
}

TEST(CaptureProxy, FlippedBytesNeverGiveIndicesOutOfRange) {
  const auto bytes = encodeCaptureProxy(withPatches());
  for (std::size_t at = 0; at < bytes.size(); ++at)
    for (unsigned bit = 0; bit < 8; ++bit) {
      auto damaged = bytes;
      damaged[at] ^= static_cast<std::byte>(1u << bit);
      const auto proxy = decode(damaged);
      if (!proxy) continue;
      for (const ProxyTriangle& triangle : proxy->triangles) {
        for (const std::uint32_t vertex : triangle.vertices) EXPECT_LT(vertex, proxy->positions.size());
        EXPECT_LT(triangle.light, 2);
        EXPECT_LE(triangle.first_entry + triangle.entry_count, proxy->entries.size());
      }
      for (const ProxyEntry& entry : proxy->entries) EXPECT_LT(entry.sample, 10u);
      for (const PatchTriangle& triangle : proxy->patches.triangles)
        for (const std::uint32_t vertex : triangle.vertices)
          EXPECT_LT(vertex, proxy->patches.positions.size());
      for (const ProxyLevel& level : proxy->levels)
        EXPECT_LE(level.first_triangle + level.triangle_count, proxy->triangles.size());
    }
}

TEST(CaptureProxy, NonsenseUnderRightLengthsIsRefusedByName) {
  const auto refused = [](auto spoil, const char* why) {
    CaptureProxy proxy = withPatches();
    spoil(proxy);
    const auto read = decode(encodeCaptureProxy(proxy));
    ASSERT_FALSE(read) << why;
    EXPECT_NE(read.error().problem.find(why), std::string::npos) << read.error().line();
  };
  refused([](CaptureProxy& p) { p.levels.clear(); }, "more or fewer parts");
  refused([](CaptureProxy& p) { p.levels[1].triangle_count = 0; }, "no or too many triangles");
  refused([](CaptureProxy& p) { p.levels[0].triangle_count = 1; }, "do not hold all triangles");
  refused([](CaptureProxy& p) { p.triangles[1].vertices[2] = 4; }, "a corner");
  refused([](CaptureProxy& p) { p.triangles[0].light = 2; }, "a light that");
  refused([](CaptureProxy& p) { p.triangles[0].emission.y = -1.0f; }, "negative light");
  refused([](CaptureProxy& p) { p.entries[1].sample = 10; }, "a sample that");
  refused([](CaptureProxy& p) { p.patches.triangles[1].vertices[0] = 4; }, "a patch with a corner");
  refused([](CaptureProxy& p) { p.patches.positions.resize(7); }, "more or fewer patches");
  refused([](CaptureProxy& p) { p.triangles[2].entry_count = 0; }, "do not hold all entries");
  refused([](CaptureProxy& p) { p.triangles[2].entry_count = 2; }, "too many entries");
  refused([](CaptureProxy& p) { p.entries[0].reflectance.y = 0.6f; }, "reflects more than it gets");
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    refused([&](CaptureProxy& p) { p.positions[0].x = bad; }, "not finite");
    refused([&](CaptureProxy& p) { p.triangles[0].emission.x = bad; }, "not finite");
    refused([&](CaptureProxy& p) { p.levels[0].error_m = bad; }, "not finite");
    refused([&](CaptureProxy& p) { p.patches.positions[2].z = bad; }, "not finite");
    refused([&](CaptureProxy& p) { p.patches.error_m = bad; }, "not finite");
  }
}

}  // namespace
}  // namespace lambent::bundle
