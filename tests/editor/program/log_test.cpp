// Tests how long notices stand over the view.
#include "editor/session/log.hpp"

#include <gtest/gtest.h>

namespace lambent::editor {
namespace {

using namespace std::chrono_literals;

TEST(LogToasts, StandFromTheirFirstFrameOnForSeconds) {
  Log log;
  EXPECT_FALSE(log.hasToasts());
  log.note("baked");
  EXPECT_TRUE(log.hasToasts());
  const std::chrono::steady_clock::time_point start;
  for (int frame = 0; frame < 50; ++frame) {
    const auto toasts = log.toasts(start + frame * 100ms);
    ASSERT_EQ(toasts.size(), 1u) << "frame " << frame;
    EXPECT_EQ(toasts.front().text, "baked");
  }
  EXPECT_TRUE(log.toasts(start + 7s).empty());
  EXPECT_FALSE(log.hasToasts());
  EXPECT_EQ(log.entries().size(), 1u) << "it stays in the log";
}

// Nobody would see a toast that stands for less time than a frame takes.
TEST(LogToasts, StandForSomeFramesHoweverSlowTheseAre) {
  Log log;
  log.warn("truncated");
  const std::chrono::steady_clock::time_point start;
  for (int frame = 0; frame < 4; ++frame) EXPECT_EQ(log.toasts(start + frame * 10s).size(), 1u);
  EXPECT_TRUE(log.toasts(start + 40s).empty());
}

TEST(LogToasts, StandAgainWhenTheyAreRepeatedAndGoWithTheLog) {
  Log log;
  log.note("saved");
  const std::chrono::steady_clock::time_point start;
  for (int frame = 0; frame < 4; ++frame) log.toasts(start + frame * 1s);
  log.note("saved");
  const auto toasts = log.toasts(start + 10s);
  ASSERT_EQ(toasts.size(), 1u);
  EXPECT_EQ(toasts.front().times, 2u);
  for (int i = 0; i < 9; ++i) log.note("note " + std::to_string(i));
  EXPECT_EQ(log.toasts(start + 11s).size(), 4u) << "the latest";
  log.clear();
  EXPECT_FALSE(log.hasToasts());
}

}  // namespace
}  // namespace lambent::editor
