#include "baker/pipeline/whole_progress.hpp"

#include <chrono>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace lambent::baker {
namespace {

void work() {
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
}

TEST(WholeProgress, GoesOverAllStagesAndNeverBack) {
  // The second stage takes far longer than expected, and the third was not expected at all.
  WholeProgress whole({{{"direct light", 0.06}, {"coding", 0.001}}});
  Progress progress;
  double before = 0.0;
  for (const char* stage : {"direct light", "coding", "proxy"}) {
    progress.begin(stage, 4, "samples");
    for (int unit = 0; unit < 4; ++unit) {
      work();
      progress.add(1);
      const auto seen = whole.look(progress);
      EXPECT_EQ(seen.stage.name, stage);
      EXPECT_GE(seen.share, before);
      EXPECT_LT(seen.share, 1.0);
      EXPECT_GE(seen.seconds_left, 0.0);
      before = seen.share;
    }
  }
  EXPECT_GT(before, 0.5);
}

TEST(WholeProgress, KnowsThatMuchIsLeftWhileAStageOfMoreBegins) {
  WholeProgress whole({{{"direct light", 0.03}, {"bounces", 10.0}}});
  Progress progress;
  progress.begin("direct light", 2, "samples");
  work();
  progress.add(2);
  EXPECT_LT(whole.look(progress).share, 0.1) << "the stage is done, and the whole is not";
  EXPECT_GT(whole.look(progress).seconds_left, 9.5) << "more on a machine that was busy meanwhile";
}

TEST(TimeLeft, FollowsRefinementFromItsBeginToItsEnd) {
  const PartSeconds expected = {{{"refinement", 10.0}}, {{"direct light", 20.0}}};
  const auto left = [&](std::uint64_t total, std::uint64_t done, double seconds) {
    return jobSeconds(expected, {}, {"refinement", "probes", total, done, seconds}).left;
  };
  const double begin = left(1000, 0, 0.0), half = left(1000, 500, 5.0), end = left(1000, 1000, 10.0);
  EXPECT_GT(begin, half + 1.0);
  EXPECT_GT(half, end + 1.0);
  EXPECT_NEAR(end, 20.0, 1e-9);
  EXPECT_NEAR(left(2000, 1000, 30.0), 30.0 + 20.0, 1e-9) << "what it learns about itself counts";
  EXPECT_GE(left(1000, 3000, 90.0), 0.0) << "more than was expected";
}

TEST(TimeLeft, ExpectsOfLaterStagesWhatSamplesTookSoFar) {
  const PartSeconds expected = {{{"direct light", 10.0}, {"bounce 1", 3.0}, {"coding", 2.0}, {"proxy", 1.0}}};
  const auto left = [&](double seconds_of_half) {
    return jobSeconds(expected, {}, {"direct light", "samples", 100, 50, seconds_of_half}).left;
  };
  EXPECT_NEAR(left(5.0), 5.0 + 3.0 + 2.0 + 1.0, 1e-9);
  EXPECT_NEAR(left(20.0), 20.0 + 4.0 * (3.0 + 2.0) + 1.0, 2.0) << "there are four times as many samples";
  EXPECT_NEAR(left(1.0), 1.0 + 0.2 * 3.0 + 2.0 + 1.0, 0.7)
      << "rays are five times as fast, which codes are not";
}

TEST(TimeLeft, IsThatOfPartsToComeAndOfNoneThatAreOver) {
  const StageSeconds group = {{"direct light", 10.0}, {"coding", 10.0}};
  const PartSeconds expected = {{{"refinement", 10.0}}, group, group, {{"writing", 1.0}}};
  const auto stage = [](const char* name, double seconds, std::size_t part, std::uint64_t done) {
    return Progress::Stage{name, "samples", 100, done, seconds, part};
  };
  std::vector<Progress::Stage> finished = {stage("refinement", 10.0, 0, 100),
                                           stage("direct light", 10.0, 1, 100)};
  EXPECT_NEAR(jobSeconds(expected, finished, stage("coding", 5.0, 1, 50)).left, 5.0 + 20.0 + 1.0, 1e-9);
  // The first group turns out not to be coded at all.
  EXPECT_NEAR(jobSeconds(expected, finished, stage("direct light", 5.0, 2, 50)).left, 5.0 + 10.0 + 1.0, 1e-9);
  finished.push_back(stage("direct light", 10.0, 2, 100));
  finished.push_back(stage("coding", 3.0, 2, 100));
  EXPECT_NEAR(jobSeconds(expected, finished, stage("writing", 0.0, 3, 0)).left, 1.0, 1e-9);
}

TEST(TimeLeft, LearnsFromWhatWasComputedAndNotFromWhatTheCacheHolds) {
  const PartSeconds expected = {{{"direct light", 10.0}, {"bounce 1", 3.0}}};
  Progress::Stage found{"direct light", "samples", 100, 100, 0.01, 0, /*found=*/true};
  const Progress::Stage now{"bounce 1", "samples", 100};
  EXPECT_NEAR(jobSeconds(expected, std::vector{found}, now).left, 3.0, 1e-9);
  EXPECT_NEAR(jobSeconds(expected, std::vector{found}, now).spent, 10.0, 1e-9) << "as though computed";
  found.found_units = 80, found.seconds = 4.0;  // 20 samples took 4 s, so all would take 20 s
  EXPECT_NEAR(jobSeconds(expected, std::vector{found}, now).left, 6.0, 0.3);
  EXPECT_NEAR(jobSeconds(expected, std::vector{found}, now).spent, 20.0, 1e-9);
}

TEST(WholeProgress, NeverFallsThoughRefinementTurnsOutLonger) {
  WholeProgress whole({{{"refinement", 0.3}, {"direct light", 0.3}}});
  Progress progress;
  progress.begin("refinement", 10, "probes");
  double before = 0.0;
  for (int unit = 0; unit < 10; ++unit) {
    work();
    progress.add(1);
    if (unit == 7) progress.expect(1000);
    const auto seen = whole.look(progress);
    EXPECT_GE(seen.share, before);
    EXPECT_GE(seen.seconds_left, 0.0);
    before = seen.share;
  }
  EXPECT_EQ(progress.now().total, 1000u);
  progress.expect(1);
  EXPECT_EQ(progress.now().total, 10u) << "what is done is no more than the total";
}

TEST(WholeProgress, CountsWhatEarlierRunsKept) {
  WholeProgress whole({{{"direct light", 30.0}, {"bounces", 10.0}}}, /*share=*/0.6);
  Progress progress;
  progress.begin("plan");
  EXPECT_NEAR(whole.look(progress).share, 0.6, 0.01);
  EXPECT_NEAR(whole.look(progress).seconds_left, 16.0, 0.5);
  // The stage finds 80 of its 100 samples at once, which says nothing about its rate.
  progress.begin("direct light", 100, "samples");
  progress.found(80);
  const auto seen = whole.look(progress);
  EXPECT_NEAR(seen.share, 0.6, 0.01);
  EXPECT_EQ(seen.units_per_s, 0.0);
  EXPECT_NEAR(seen.seconds_left, 6.0 + 10.0, 0.5);
}

}  // namespace
}  // namespace lambent::baker
