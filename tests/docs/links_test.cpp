// Checks links between pages of the documentation: the file must exist, and so must the heading that is
// named.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/base/atomic_file.hpp"
#include "tests/docs/source.hpp"

namespace lambent {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> pages() {
  std::vector<fs::path> found = {kSource / "README.md", kSource / "CHANGELOG.md",
                                 kSource / "CONTRIBUTING.md"};
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kSource / "docs"))
    if (entry.path().extension() == ".md") found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

std::string textOf(const fs::path& page) {
  const Result<std::string> text = readTextFile(page);
  return text ? *text : std::string();
}

// Returns the anchor that GitHub makes for a heading: lower case, spaces as hyphens, without punctuation.
std::string anchorOf(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == ' ')
      anchor += '-';
    else if (std::isalnum(byte) || c == '-' || c == '_' || byte >= 0x80)
      anchor += static_cast<char>(std::tolower(byte));
  }
  return anchor;
}

std::set<std::string> anchorsOf(const fs::path& page) {
  std::set<std::string> anchors;
  std::istringstream lines(textOf(page));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t hashes = line.find_first_not_of('#');
    if (hashes != 0 && hashes != std::string::npos && line[hashes] == ' ')
      anchors.insert(anchorOf(line.substr(hashes + 1)));
  }
  return anchors;
}

TEST(Links, LeadToFilesAndHeadingsThatAreThere) {
  const std::regex link(R"(\]\(([^)#\s]*)(#[^)\s]*)?\))");
  std::size_t followed = 0;
  for (const fs::path& page : pages()) {
    const std::string text = textOf(page);
    ASSERT_FALSE(text.empty()) << page;
    for (std::sregex_iterator match(text.begin(), text.end(), link), end; match != end; ++match) {
      const std::string file = (*match)[1], anchor = (*match)[2];
      if (file.find("://") != std::string::npos) continue;
      const fs::path target = file.empty() ? page : page.parent_path() / file;
      EXPECT_TRUE(fs::exists(target)) << page << ": " << file;
      if (!anchor.empty()) {
        EXPECT_TRUE(anchorsOf(target).contains(anchor.substr(1))) << page << ": " << file << anchor;
      }
      ++followed;
    }
  }
  EXPECT_GT(followed, 50u);
}

// Holds the table of docs/stability.md against the tests: each that it names must be there.

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
