// Proves that a test which lacks something skips, and that it fails where LAMBENT_REQUIRE names the thing.
#include "tests/support/require.hpp"

#include <cstdlib>
#include <optional>
#include <string>

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

namespace lambent {
namespace {

void lackGl() {
  LAMBENT_LACKS("gl", "no OpenGL 4.5 here");
}

class Require : public ::testing::Test {
 protected:
  void TearDown() override {
    if (before)
      ::setenv("LAMBENT_REQUIRE", before->c_str(), /*overwrite=*/1);
    else
      ::unsetenv("LAMBENT_REQUIRE");
  }
  std::optional<std::string> before = std::getenv("LAMBENT_REQUIRE")
                                          ? std::optional<std::string>(std::getenv("LAMBENT_REQUIRE"))
                                          : std::nullopt;
};

TEST_F(Require, NamesWholeWordsOfItsList) {
  EXPECT_TRUE(testing::names("gl", "gl"));
  EXPECT_TRUE(testing::names("data,gl,validator", "gl"));
  EXPECT_FALSE(testing::names("", "gl"));
  EXPECT_FALSE(testing::names("glx,data", "gl"));
  EXPECT_FALSE(testing::names("data", "gl"));
}

TEST_F(Require, FailsATestThatLacksWhatItNames) {
  ::setenv("LAMBENT_REQUIRE", "data,gl", 1);
  EXPECT_FATAL_FAILURE(lackGl(), "no OpenGL 4.5 here; LAMBENT_REQUIRE has gl");
}

TEST_F(Require, LeavesATestThatLacksSomethingElseToSkip) {
  ::setenv("LAMBENT_REQUIRE", "data", 1);
  ::testing::TestPartResultArray results;
  {
    const ::testing::ScopedFakeTestPartResultReporter reporter(
        ::testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &results);
    lackGl();
  }
  ASSERT_EQ(results.size(), 1);
  EXPECT_TRUE(results.GetTestPartResult(0).skipped());
}

}  // namespace
}  // namespace lambent
