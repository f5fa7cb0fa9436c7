#include "runtime/base/atomic_file.hpp"

#include <fstream>
#include <iterator>
#include <utility>

#include <gtest/gtest.h>
#include <unistd.h>

namespace lambent {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lambent-atomic-test-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    std::ofstream(folder_ / "file") << "old";
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::ptrdiff_t files() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  fs::path folder_;
};

TEST_F(AtomicFileTest, AppearsOnlyOnCommit) {
  auto file = AtomicFile::open(folder_ / "file");
  ASSERT_TRUE(file) << file.error().line();
  ASSERT_TRUE(file->write(std::string("new")));
  EXPECT_EQ(*readTextFile(folder_ / "file"), "old");
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(*readTextFile(folder_ / "file"), "new");
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFileTest, LeavesNothingWithoutCommit) {
  {
    auto file = AtomicFile::open(folder_ / "file");
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write(std::string("half")));
    AtomicFile moved = std::move(*file);
    EXPECT_EQ(files(), 2);
  }
  EXPECT_EQ(*readTextFile(folder_ / "file"), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFileTest, SaysWhyItCannotBeWritten) {
  EXPECT_NE(AtomicFile::open("/dev/null").error().problem.find("device"), std::string::npos);
  EXPECT_NE(AtomicFile::open(folder_).error().problem.find("folder"), std::string::npos);
  EXPECT_NE(AtomicFile::open(folder_ / "missing" / "file").error().problem.find("folder does not exist"),
            std::string::npos);
}

TEST_F(AtomicFileTest, ReadingNamesWhatIsWrong) {
  EXPECT_EQ(readTextFile(folder_ / "nothing").error().problem, "no such file");
  EXPECT_EQ(readTextFile(folder_).error().problem, "is a folder");
}

}  // namespace
}  // namespace lambent
