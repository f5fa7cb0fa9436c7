// Checks that docs/rooms.md lists every room. A room is a folder whose CMakeLists.txt makes a library or a
// program; a row of the list begins with the folder's name in backquotes.
#include <filesystem>
#include <set>
#include <sstream>
#include <string>

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

}  // namespace
}  // namespace lambent
