#include <gtest/gtest.h>

#include "runtime/base/process.hpp"

namespace lambent {
namespace {

TEST(RunProgram, ReturnsWhatAProgramPrintsWithoutAShellBetween) {
  const auto out = runProgram("/bin/echo", {"a b", "$HOME", "'"}, {});
  ASSERT_TRUE(out) << out.error().line();
  EXPECT_EQ(out->out, "a b $HOME '\n");
}

TEST(RunProgram, FailsWithTheLastLineOfTheErrors) {
  const auto out = runProgram("/bin/sh", {"-c", "echo one >&2; echo two >&2; exit 3"}, {});
  ASSERT_FALSE(out);
  EXPECT_NE(out.error().line().find("two"), std::string::npos) << out.error().line();
  EXPECT_EQ(out.error().line().find("one"), std::string::npos) << out.error().line();
}

TEST(RunProgram, LeavesTheExitCodeToTheCallerWhoAsksForIt) {
  const auto out = runToAnyEnd("/bin/sh", {"-c", "echo said; exit 3"}, {});
  ASSERT_TRUE(out) << out.error().line();
  EXPECT_EQ(out->exit_code, 3);
  EXPECT_EQ(out->out, "said\n");
}

// Far more than a pipe holds, on both streams.
TEST(RunProgram, ReadsBothStreamsToTheirEnds) {
  const auto out =
      runProgram("/bin/sh",
                 {"-c",
                  "i=0; while [ $i -lt 3000 ]; do echo 0123456789012345678901234567890123456789; echo e >&2; "
                  "echo 0123456789012345678901234567890123456789 >&2; i=$((i+1)); done"},
                 {});
  ASSERT_TRUE(out) << out.error().line();
  EXPECT_EQ(out->out.size(), 3000u * 41u);
}

TEST(RunProgram, EndsWhenAStopIsRequested) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(runProgram("/bin/sleep", {"60"}, stop.get_token())) << "it ended by itself";
}

}  // namespace
}  // namespace lambent
