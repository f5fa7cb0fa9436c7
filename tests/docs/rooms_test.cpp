// Checks that docs/rooms.md lists every room. A room is a folder whose CMakeLists.txt makes a library or a
// program; a row of the list begins with the folder's name in backquotes.
#include <algorithm>
#include <filesystem>
#include <iterator>
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

bool makesATarget(const fs::path& cmake_lists) {
  const Result<std::string> text = readTextFile(cmake_lists);
  return text && (text->find("lambent_room(") != std::string::npos ||
                  text->find("lambent_program(") != std::string::npos ||
                  text->find("lambent_library(") != std::string::npos ||
                  text->find("pybind11_add_module(") != std::string::npos);
}

std::set<std::string> roomsOnDisk() {
  std::set<std::string> rooms;
  for (const char* root : {"runtime", "baker", "reference", "editor", "assets"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kSource / root))
      if (entry.path().filename() == "CMakeLists.txt" && makesATarget(entry.path()))
        rooms.insert(fs::relative(entry.path().parent_path(), kSource).generic_string());
  return rooms;
}

// Returns the first cells of all rows of the tables that are headed "| room | owns |".
std::multiset<std::string> roomsListed(const std::string& page) {
  std::multiset<std::string> rooms;
  std::istringstream lines(page);
  bool in_list = false;
  for (std::string line; std::getline(lines, line);) {
    if (line == "| room | owns |") in_list = true;
    if (line.empty()) in_list = false;
    const std::string start = "| `";
    if (!in_list || line.rfind(start, 0) != 0) continue;
    rooms.insert(line.substr(start.size(), line.find('`', start.size()) - start.size()));
  }
  return rooms;
}

class Rooms : public testing::Test {
 protected:
  void SetUp() override {
    const Result<std::string> page = readTextFile(kSource / "docs/rooms.md");
    ASSERT_TRUE(page) << page.error().line();
    listed_ = roomsListed(*page);
    ASSERT_FALSE(listed_.empty());
  }

  std::multiset<std::string> listed_;
  std::set<std::string> on_disk_ = roomsOnDisk();
};

TEST_F(Rooms, EveryRoomStandsInTheListOnce) {
  for (const std::string& room : on_disk_) EXPECT_EQ(listed_.count(room), 1u) << room;
}

TEST_F(Rooms, EveryListedRoomIsAFolder) {
  for (const std::string& room : listed_) EXPECT_TRUE(on_disk_.contains(room)) << room;
}

// The rooms of runtime and baker are listed in their CMakeLists.txt in the order of the data. A file may
// include files of its own room and of rooms above it in that list, and the runtime none of the baker.

// Returns the names in `foreach(room ...)`.
std::vector<std::string> roomsInOrder(const std::string& root) {
  const Result<std::string> text = readTextFile(kSource / root / "CMakeLists.txt");
  std::smatch list;
  if (!text || !std::regex_search(*text, list, std::regex(R"(foreach\(room ([^)]*)\))"))) return {};
  std::istringstream words(list[1].str());
  return {std::istream_iterator<std::string>(words), {}};
}

// Returns the index in the list of the room that holds the file "runtime/ROOM/FILE", or the list's size.
std::size_t placeOf(const std::vector<std::string>& rooms, const std::string& root, const std::string& file) {
  return static_cast<std::size_t>(
      std::ranges::find_if(
          rooms, [&](const std::string& room) { return file.starts_with(root + "/" + room + "/"); }) -
      rooms.begin());
}

struct Arrow {
  std::string from, to;  // files, from the root of the project
};

// Returns every include, by a file under the folder `root`, of a file of the project.
std::vector<Arrow> includesOf(const std::string& root) {
  const std::regex include(R"re(#include "((?:runtime|baker|reference|editor)/[^"]+)")re");
  std::vector<Arrow> arrows;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kSource / root)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".hpp" && extension != ".cpp" && extension != ".h") continue;
    const Result<std::string> text = readTextFile(entry.path());
    EXPECT_TRUE(text) << text.error().line();
    for (std::sregex_iterator found(text->begin(), text->end(), include), end; found != end; ++found)
      arrows.push_back({fs::relative(entry.path(), kSource).generic_string(), (*found)[1].str()});
  }
  EXPECT_GT(arrows.size(), 50u);
  return arrows;
}

void expectNothingRunsUp(const std::string& root) {
  const std::vector<std::string> rooms = roomsInOrder(root);
  ASSERT_FALSE(rooms.empty());
  for (const Arrow& arrow : includesOf(root))
    if (arrow.to.starts_with(root + "/"))
      EXPECT_LE(placeOf(rooms, root, arrow.to), placeOf(rooms, root, arrow.from))
          << arrow.from << " includes " << arrow.to;
    else
      EXPECT_TRUE(root == "baker" && (arrow.to.starts_with("runtime/") || arrow.to.starts_with("reference/")))
          << arrow.from << " includes " << arrow.to;
}

TEST(Includes, OfTheRuntimeRunDownTheListOfItsRooms) {
  expectNothingRunsUp("runtime");
}

TEST(Includes, OfTheBakerRunDownTheListOfItsRooms) {
  expectNothingRunsUp("baker");
}

// The reference checks the baker, so it shares nothing with it but the imported scene. baker/embree only
// spells the calls of a library, by which nothing about rays is decided.
TEST(Includes, OfTheReferenceAreItsOwnAndThoseOfTheImport) {
  const char* const kKnown[] = {"reference/",      "baker/cache/", "baker/embree/",
                                "baker/import/",   "baker/jobs/",  "runtime/base/",
                                "runtime/bundle/", "runtime/sh/",  "runtime/spec/"};
  for (const Arrow& arrow : includesOf("reference"))
    EXPECT_TRUE(std::ranges::any_of(kKnown, [&](const char* room) { return arrow.to.starts_with(room); }))
        << arrow.from << " includes " << arrow.to;
}

}  // namespace
}  // namespace lambent
