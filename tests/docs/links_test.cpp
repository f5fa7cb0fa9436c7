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

}  // namespace
}  // namespace lambent
