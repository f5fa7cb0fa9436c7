// Tests the helpers of tests.
//
// Proves that tests which gather the largest difference fail on NaN, and that they gather it with the helper
// for which that is so.
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include "runtime/base/atomic_file.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

namespace fs = std::filesystem;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// Holds what a broken shader gives against what is expected, as tests do.
void expectNoDifference(const std::vector<float>& got) {
  float largest = 0.0f;
  for (const float value : got) largest = testing::larger(largest, std::abs(value - 1.0f));
  EXPECT_LT(largest, 0.1f);
}

TEST(Differences, FailATestWhereverItsNaNStands) {
  expectNoDifference({1.0f, 1.05f, 1.0f});
  EXPECT_NONFATAL_FAILURE(expectNoDifference({kNaN, kNaN, kNaN}), "largest");
  EXPECT_NONFATAL_FAILURE(expectNoDifference({kNaN, 1.0f, 1.0f}), "largest");
  EXPECT_NONFATAL_FAILURE(expectNoDifference({1.0f, kNaN, 1.0f}), "largest");
  EXPECT_NONFATAL_FAILURE(expectNoDifference({1.0f, 1.0f, kNaN}), "largest");
  EXPECT_NONFATAL_FAILURE(expectNoDifference({1.0f, 1.2f, 1.0f}), "largest");
}

TEST(Differences, KeepNaNInTheSmallestToo) {
  EXPECT_TRUE(std::isnan(testing::smaller(kNaN, 1.0f)));
  EXPECT_TRUE(std::isnan(testing::smaller(1.0f, kNaN)));
  EXPECT_EQ(testing::smaller(1.0f, -2.0f), -2.0f);
  EXPECT_EQ(testing::smaller(-2.0, 1.0), -2.0);
}

TEST(Differences, OfListsFailOnNaNOnOtherLengthsAndOnNothing) {
  const std::vector<float> ones(3, 1.0f), none;
  EXPECT_EQ(testing::largestDifference(ones, std::vector<double>{1.0, 0.5, 1.25}), 0.5);
  EXPECT_TRUE(std::isnan(testing::largestDifference(ones, std::vector<float>{1.0f, kNaN, 1.0f})));
  EXPECT_TRUE(std::isnan(testing::largestDifference(ones, std::vector<float>{1.0f, 1.0f})));
  EXPECT_TRUE(std::isnan(testing::largestDifference(none, none)));
}

// std::max(x, NaN) is x, and x > bound is false for NaN.
TEST(Differences, AreGatheredByTheHelperInAllTests) {
  const std::regex gathers(
      R"(([A-Za-z_][\w.\[\]]*)\s*=\s*std::(max|min)(<\w+>)?\(\{?\s*\1,[^;]*(abs|length|distance)\()");
  const std::regex counts(
      R"(if \((std::abs|glm::distance|glm::length)\([^;]*\) > [^;|&]*\) (\+\+\w+|\w+\+\+);)");
  std::size_t files = 0;
  for (const fs::directory_entry& entry :
       fs::recursive_directory_iterator(fs::path(LAMBENT_SOURCE_DIR) / "tests")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".hpp" && extension != ".cpp") continue;
    const Result<std::string> text = readTextFile(entry.path());
    ASSERT_TRUE(text) << text.error().line();
    ++files;
    for (const std::regex* wrong : {&gathers, &counts}) {
      std::smatch found;
      EXPECT_FALSE(std::regex_search(*text, found, *wrong))
          << entry.path() << ": " << found.str()
          << "\nkeeps quiet about NaN; see tests/support/differences.hpp";
    }
  }
  EXPECT_GT(files, 200u);
}

// Proves that a test which lacks something skips, and that it fails where LAMBENT_REQUIRE names the thing.

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
