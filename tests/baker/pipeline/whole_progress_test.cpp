#include "baker/pipeline/whole_progress.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace lambent::baker {
namespace {

Progress::Stage stage(const char* name, double seconds, std::uint64_t done, std::size_t part = 0) {
  return {name, "samples", 100, done, seconds, part};
}

TEST(WholeProgress, GoesOverAllStagesAndNeverBack) {
  // The third stage was not expected at all, and the first one learns as it goes how much there is to do.
  WholeProgress whole({{{"direct light", 6.0}, {"coding", 4.0}}});
  Progress progress;
  double before = 0.0;
  for (const char* name : {"direct light", "coding", "proxy"}) {
    progress.begin(name, 4, "samples");
    for (int unit = 0; unit < 4; ++unit) {
      progress.add(1);
      if (unit == 2) progress.expect(1000);
      const auto seen = whole.look(progress);
      EXPECT_EQ(seen.stage.name, name);
      EXPECT_GE(seen.share, before);
      EXPECT_LT(seen.share, 1.0);
      EXPECT_GE(seen.seconds_left, 0.0);
      before = seen.share;
    }
    EXPECT_EQ(progress.now().total, 1000u);
    progress.expect(1);
    EXPECT_EQ(progress.now().total, 4u) << "what is done is no more than the total";
  }
  EXPECT_GT(before, 0.9);
}

TEST(WholeProgress, CountsJobsBeforeAndAfter) {
  Progress progress;
  progress.begin("direct light", 2, "samples");
  progress.add(1);
  EXPECT_NEAR(WholeProgress({{{"direct light", 4.0}}}).look(progress).share, 0.5, 1e-9);
  EXPECT_NEAR(WholeProgress({{{"direct light", 4.0}}}, 6.0).look(progress).share, 0.8, 1e-9);
  EXPECT_NEAR(WholeProgress({{{"direct light", 4.0}}}, 0.0, 6.0).look(progress).share, 0.2, 1e-9);
}

TEST(WholeProgress, SaysNothingOfTheRateOfWhatTheCacheHolds) {
  WholeProgress whole({{{"direct light", 30.0}, {"bounces", 10.0}}});
  Progress progress;
  progress.begin("direct light", 100, "samples");
  progress.found(80);
  const auto seen = whole.look(progress);
  EXPECT_NEAR(seen.share, 0.6, 1e-9) << "as though computed";
  EXPECT_EQ(seen.units_per_s, 0.0);
  EXPECT_NEAR(seen.seconds_left, 6.0 + 10.0, 1e-9);
}

TEST(JobSeconds, FollowThePaceOfWhatWasComputed) {
  const PartSeconds expected = {{{"direct light", 10.0}, {"bounce 1", 3.0}, {"coding", 2.0}}};
  const auto left = [&](double seconds_of_half) {
    const JobSeconds job = jobSeconds(expected, {stage("direct light", seconds_of_half, 50)});
    EXPECT_NEAR(job.done, 5.0, 1e-9);
    return job.pace * job.left;
  };
  EXPECT_NEAR(left(5.0), 10.0, 1e-9);
  EXPECT_NEAR(left(20.0), 40.0, 5.0) << "there are four times as many samples";
  EXPECT_NEAR(left(1.0), 2.0, 1.2) << "rays are five times as fast";
}

TEST(JobSeconds, AreLeftOfPartsToComeAndNotOfThoseThatAreOver) {
  const StageSeconds group = {{"direct light", 10.0}, {"coding", 10.0}};
  const PartSeconds expected = {{{"refinement", 10.0}}, group, group, {{"writing", 1.0}}};
  const std::vector<Progress::Stage> begin = {stage("refinement", 10.0, 100),
                                              stage("direct light", 10.0, 100, 1)};
  const auto left = [&](std::vector<Progress::Stage> more) {
    more.insert(more.begin(), begin.begin(), begin.end());
    return jobSeconds(expected, more).left;
  };
  EXPECT_NEAR(left({stage("coding", 5.0, 50, 1)}), 5.0 + 20.0 + 1.0, 1e-9);
  EXPECT_NEAR(left({stage("direct light", 5.0, 50, 2)}), 5.0 + 10.0 + 1.0, 1e-9)
      << "the first needs no codes";
  EXPECT_NEAR(
      left({stage("direct light", 10.0, 100, 2), stage("coding", 3.0, 100, 2), stage("writing", 0.0, 0, 3)}),
      1.0, 1e-9);
}

TEST(JobSeconds, LearnNothingFromWhatTheCacheHolds) {
  const PartSeconds expected = {{{"direct light", 10.0}, {"bounce 1", 3.0}}};
  Progress::Stage found = stage("direct light", 0.01, 100);
  found.found = true;
  const JobSeconds job = jobSeconds(expected, {found, stage("bounce 1", 0.0, 0)});
  EXPECT_NEAR(job.done, 10.0, 1e-9);
  EXPECT_NEAR(job.pace * job.left, 3.0, 1e-9);
}

}  // namespace
}  // namespace lambent::baker
