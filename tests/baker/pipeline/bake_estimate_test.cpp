// Tests what is said beforehand of a bake, and which options a time buys.
#include "baker/pipeline/bake_estimate.hpp"

#include <gtest/gtest.h>

#include "baker/bake/option_rows.hpp"
#include "baker/pipeline/guess_seconds.hpp"
#include "baker/pipeline/long_bake.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

Scene boxAboveFloor() {
  return testing::sceneOf({testing::grid({0.0f, 0.0f, 0.0f}, 4.0f, 12),
                           testing::box({0.13f, 0.6f, -0.21f}, {0.7f, 0.8f, 0.7f}, 4)});
}

double guessOf(const Scene& scene, const BakeOptions& options) {
  const auto plan = planFor(scene, options);
  EXPECT_TRUE(plan);
  return plan ? sumSeconds(guessProcessorSeconds(scene, *plan, options)) : 0.0;
}

TEST(GuessedSeconds, OfARoomAreMoreThanOfABodySeenFromOutside) {
  const auto box = testing::box({0.0f, 1.5f, 0.0f}, {4.0f, 3.0f, 5.0f}, 10);
  auto room = box;
  for (std::size_t i = 0; i < room.indices.size(); i += 3) std::swap(room.indices[i], room.indices[i + 1]);
  for (glm::vec3& normal : room.normals) normal = -normal;
  EXPECT_GT(guessOf(testing::sceneOf({room}), {}), 5.0 * guessOf(testing::sceneOf({box}), {}));
}

// The seconds of a guess are no test's business, but what they grow with is.
TEST(LongBake, IsGuessedFromWhatIsDrawnAndItsRays) {
  Scene scene = boxAboveFloor();
  const auto guess = [&](const BakeOptions& options) { return guessOf(scene, options); };
  const BakeOptions draft{.quality = Quality::Draft};
  const double once = guess(draft);
  EXPECT_GT(once, 0.0);
  EXPECT_FALSE(longBakeNotice(once));
  EXPECT_GT(guess({.quality = Quality::Draft, .rays = 65536}), 50.0 * once);
  constexpr std::size_t kCopies = 400;
  for (std::size_t i = 1; i < kCopies; ++i)
    for (std::size_t n = 0; n < 2; ++n) {
      scene.roots.push_back(static_cast<std::int32_t>(scene.nodes.size()));
      scene.nodes.push_back(scene.nodes[n]);
      scene.nodes.back().parent_from_node[3] += glm::vec4(5.0f * static_cast<float>(i), 0.0f, 0.0f, 0.0f);
    }
  const double often = guess(draft);
  EXPECT_GT(often, 0.4 * static_cast<double>(kCopies) * once);
  const auto notice = longBakeNotice(often);
  ASSERT_TRUE(notice) << often << " s";
  EXPECT_TRUE(notice->starts_with("takes about ")) << *notice;
}

// Seconds depend on what else the machine does, so they are not held against each other here.
TEST(BakeEstimate, IsWithinAFactorOfOneAndAHalf) {
  const Scene scene = boxAboveFloor();
  const BakeOptions options{.quality = Quality::Draft};
  const testing::TemporaryFolder folder;
  Progress progress;
  const auto estimate = estimateBake(scene, options, {progress});
  ASSERT_TRUE(estimate) << estimate.error().line();
  const auto report = bake(scene, options, folder.path() / "scene.lmb.glb", {progress});
  ASSERT_TRUE(report) << report.error().line();
  const auto near = [](double estimated, std::uint64_t measured, const char* what) {
    EXPECT_LT(estimated, 1.5 * static_cast<double>(measured)) << what;
    EXPECT_GT(1.5 * estimated, static_cast<double>(measured)) << what;
  };
  near(estimate->samples, report->samples, "samples");
  near(estimate->rays, report->rays, "rays");
  near(estimate->bytes, report->file_bytes, "bytes");
  ASSERT_EQ(estimate->groups.size(), 1u);
  near(estimate->groups[0].samples, report->groups[0].samples, "samples of the group");
  near(estimate->groups[0].bytes, report->groups[0].transfer_bytes, "bytes of the group");
  EXPECT_GT(estimate->seconds, estimate->groups[0].seconds) << "refinement and meshes are of no group";
}

TEST(BakeEstimate, IsFoundForTheSameSceneAndOptionsOnly) {
  const testing::TemporaryFolder folder;
  auto cache = Cache::open(folder.path());
  ASSERT_TRUE(cache);
  const Scene scene = boxAboveFloor();
  const BakeOptions options{.quality = Quality::Draft};
  BakeEstimate estimate;
  estimate.seconds = 12.5, estimate.bytes = 77.0, estimate.parts = {{{"import", 1.0}}, {{"coding", 2.0}}};
  keepEstimate(scene, options, estimate, *cache);
  const auto found = findEstimate(scene, options, *cache);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->seconds, 12.5);
  EXPECT_EQ(found->bytes, 77.0);
  EXPECT_EQ(found->parts, estimate.parts);
  EXPECT_FALSE(findEstimate(scene, {.quality = Quality::High}, *cache));
}

}  // namespace
}  // namespace lambent::baker
