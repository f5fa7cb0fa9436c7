// Patches of samples, and light that bounces between them, in a room with more samples than there are
// patches.
#include "baker/trace/patches.hpp"

#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::cup;
using testing::flipped;
using testing::sceneOf;
using testing::Transport;
using testing::uniformRadiance;

// An open white room with a closed dark one standing in it, whose walls are thin.
struct DarkBox {
  Transport t{sceneOf({cup({4, 2, 4}, 20), box({0, -0.2f, 0}, {1, 0.7f, 1}, 6),
                       flipped(box({0, -0.2f, 0}, {0.98f, 0.68f, 0.98f}, 10))})};

  // Returns whether a sample faces the inside of the dark room.
  bool isDark(std::size_t s) const {
    const glm::vec3 p = t.samples.positions[s] - glm::vec3(0.0f, -0.2f, 0.0f);
    return std::abs(p.x) < 0.495f && std::abs(p.y) < 0.345f && std::abs(p.z) < 0.495f;
  }
};

TEST(Patches, HaveEverySampleOnceAndNeverJoinLightAndDark) {
  const DarkBox room;
  const std::size_t count = room.t.samples.size();
  ASSERT_GT(count, kMostPatches);
  std::vector<float> brightness(count);
  for (std::size_t s = 0; s < count; ++s) brightness[s] = room.isDark(s) ? 0.0f : 1.0f;
  const std::vector<std::uint8_t> valid(count, 1);
  const std::vector<float> weights(count, 0.5f);
  const Patches patches = choosePatches(
      room.t.samples, 6.0f,
      {.brightness = brightness, .bounced = brightness, .weights = weights, .valid = valid}, {});
  EXPECT_LE(patches.size(), kMostPatches);
  EXPECT_GE(patches.size(), kMostPatches - 8);
  std::vector<int> times(count, 0);
  for (std::size_t patch = 0; patch < patches.size(); ++patch) {
    float shares = 0.0f;
    ASSERT_LT(patches.offsets[patch], patches.offsets[patch + 1]);
    for (std::uint32_t i = patches.offsets[patch]; i < patches.offsets[patch + 1]; ++i) {
      const std::uint32_t s = patches.samples[i];
      ++times[s];
      EXPECT_EQ(patches.of_sample[s], patch);
      EXPECT_EQ(room.isDark(s), room.isDark(patches.samples[patches.offsets[patch]]));
      shares += patches.shares[i];
    }
    EXPECT_NEAR(shares, 1.0f, 1e-4f);
  }
  for (const int n : times) EXPECT_EQ(n, 1);
}

TEST(Patches, PassNoLightThroughWalls) {
  const DarkBox room;
  const auto baked = room.t.bake(3, 256, -1);
  ASSERT_GT(baked.bounced.energy.size(), 4u);
  double lit = 0.0;
  for (std::size_t s = 0; s < room.t.samples.size(); ++s) {
    const float light =
        uniformRadiance(baked.direct.field.at(s)) + uniformRadiance(baked.bounced.field.at(s));
    if (room.isDark(s))
      EXPECT_LT(std::abs(light), 1e-4f);
    else
      lit += double{light};
  }
  EXPECT_GT(lit, 100.0);
}

TEST(Patches, LoseNoLightInAWhiteRoom) {
  const DarkBox room;
  const auto baked = room.t.bake(3, 256, kMostBounces);
  double sum = 0.0;
  int count = 0;
  for (std::size_t s = 0; s < room.t.samples.size(); ++s) {
    if (room.isDark(s) || room.t.samples.originsOf(s).empty() || baked.direct.looks.valid[s] == 0) continue;
    const float light =
        uniformRadiance(baked.direct.field.at(s)) + uniformRadiance(baked.bounced.field.at(s));
    // In edges, where light varies most over a patch. Bounces of albedo 1 are the worst case: with less,
    // patches carry less of the light.
    EXPECT_NEAR(light, 1.0f, 0.12f);
    sum += double{light};
    ++count;
  }
  EXPECT_NEAR(sum / count, 1.0, 3e-3);
}

}  // namespace
}  // namespace lambent::baker
