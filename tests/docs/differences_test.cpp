// Proves that tests which gather the largest difference fail on NaN, and that they gather it with the helper
// for which that is so.
#include "tests/support/differences.hpp"

#include <filesystem>
#include <limits>
#include <regex>
#include <vector>

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include "runtime/base/atomic_file.hpp"

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
  EXPECT_GT(files, 300u);
}

}  // namespace
}  // namespace lambent
