// Holds the table of docs/stability.md against the tests: each that it names must be there.
#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "runtime/base/atomic_file.hpp"

namespace lambent {
namespace {

namespace fs = std::filesystem;

TEST(Stability, NamesTestsThatAreThere) {
  std::set<std::string> tests;
  const std::regex declared(R"(\nTEST(?:_F|_P)?\((\w+), (\w+)\))");
  for (const fs::directory_entry& entry :
       fs::recursive_directory_iterator(fs::path(LAMBENT_SOURCE_DIR) / "tests")) {
    if (entry.path().extension() != ".cpp") continue;
    const Result<std::string> text = readTextFile(entry.path());
    ASSERT_TRUE(text) << text.error().line();
    for (std::sregex_iterator found(text->begin(), text->end(), declared), end; found != end; ++found)
      tests.insert((*found)[1].str() + "." + (*found)[2].str());
  }
  const Result<std::string> table = readTextFile(fs::path(LAMBENT_SOURCE_DIR) / "docs/stability.md");
  ASSERT_TRUE(table) << table.error().line();
  // `Suite.Test`, and `.Test` for another of the same suite.
  const std::regex named(R"(`([A-Z]\w*)?\.([A-Z]\w+)`)");
  std::string suite;
  std::size_t count = 0;
  for (std::sregex_iterator found(table->begin(), table->end(), named), end; found != end; ++found, ++count) {
    if ((*found)[1].matched) suite = (*found)[1];
    const std::string name = suite + "." + (*found)[2].str();
    EXPECT_TRUE(tests.contains(name)) << name;
  }
  EXPECT_GT(count, 60u);
}

}  // namespace
}  // namespace lambent
