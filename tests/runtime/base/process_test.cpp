#include "runtime/base/process.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

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

TEST(OwnProgram, IsThisTest) {
  const Result<std::filesystem::path> program = ownProgram();
  ASSERT_TRUE(program) << program.error().line();
  EXPECT_EQ(program->filename(), "test_base");
  EXPECT_TRUE(std::filesystem::is_regular_file(*program));
}

TEST(OwnProgram, FindsSamplesInABuildAndWhereItIsInstalled) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path program = folder.path() / "bin/lambent";
  EXPECT_TRUE(sampleFolders(program).empty());
  std::filesystem::create_directories(folder.path() / "share/lambent/probes");
  EXPECT_EQ(sampleFolders(program), std::vector{folder.path() / "share/lambent/probes"});
  std::filesystem::create_directories(folder.path() / "assets");
  EXPECT_EQ(sampleFolders(program).back(), folder.path() / "assets");
}

}  // namespace
}  // namespace lambent
