#include <gtest/gtest.h>

#include "runtime/base/process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent {
namespace {

namespace fs = std::filesystem;

TEST(OwnProgram, IsThisTest) {
  const Result<fs::path> program = ownProgram();
  ASSERT_TRUE(program) << program.error().line();
  EXPECT_EQ(program->filename(), "test_base");
  EXPECT_TRUE(fs::is_regular_file(*program));
}

TEST(OwnProgram, FindsSamplesInABuildAndWhereItIsInstalled) {
  const testing::TemporaryFolder folder;
  const fs::path program = folder.path() / "bin/lambent";
  EXPECT_TRUE(sampleFolders(program).empty());
  fs::create_directories(folder.path() / "share/lambent/probes");
  EXPECT_EQ(sampleFolders(program), std::vector{folder.path() / "share/lambent/probes"});
  fs::create_directories(folder.path() / "assets");
  EXPECT_EQ(sampleFolders(program).back(), folder.path() / "assets");
}

}  // namespace
}  // namespace lambent
