// Tests what is said beforehand of a bake.
#include <gtest/gtest.h>

#include "baker/bake/bake.hpp"
#include "baker/pipeline/whole_progress.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {
namespace {

Scene boxAboveFloor() {
  return testing::sceneOf({testing::grid({0.0f, 0.0f, 0.0f}, 4.0f, 12),
                           testing::box({0.13f, 0.6f, -0.21f}, {0.7f, 0.8f, 0.7f}, 4)});
}

BakeGuess guessOf(const Scene& scene, const BakeOptions& options) {
  const auto plan = planFor(scene, options);
  EXPECT_TRUE(plan);
  return plan ? guessBake(scene, *plan, options) : BakeGuess{};
}

double secondsOf(const Scene& scene, const BakeOptions& options) {
  return guessOf(scene, options).processor_seconds;
}

TEST(GuessedSeconds, OfARoomAreMoreThanOfABodySeenFromOutside) {
  const auto box = testing::box({0.0f, 1.5f, 0.0f}, {4.0f, 3.0f, 5.0f}, 10);
  auto room = box;
  for (std::size_t i = 0; i < room.indices.size(); i += 3) std::swap(room.indices[i], room.indices[i + 1]);
  for (glm::vec3& normal : room.normals) normal = -normal;
  EXPECT_GT(secondsOf(testing::sceneOf({room}), {}), 5.0 * secondsOf(testing::sceneOf({box}), {}));
}

// The seconds of a guess are no test's business, but what they grow with is.
TEST(LongBake, IsGuessedFromWhatIsDrawnAndItsRays) {
  Scene scene = boxAboveFloor();
  const auto guess = [&](const BakeOptions& options) { return secondsOf(scene, options); };
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

TEST(BakeGuess, CountsSamplesWithinAFactorOfThreeAndRaysOfSix) {
  const Scene scene = boxAboveFloor();
  const BakeOptions options{.quality = Quality::Draft};
  const BakeGuess guess = guessOf(scene, options);
  const testing::TemporaryFolder folder;
  Progress progress;
  const auto report = bake(scene, options, folder.path() / "scene.lmb.glb", {progress});
  ASSERT_TRUE(report) << report.error().line();
  // Points inside faces, of which there may be two a vertex, have rays too.
  const auto near = [](double guessed, std::uint64_t measured, double times, const char* what) {
    EXPECT_LT(guessed, times * static_cast<double>(measured)) << what;
    EXPECT_GT(times * guessed, static_cast<double>(measured)) << what;
  };
  near(guess.samples, report->samples, 3.0, "samples");
  near(guess.rays, report->rays, 6.0, "rays");
  EXPECT_GT(guess.memory_bytes, 0.0);
}

}  // namespace
}  // namespace lambent::baker
