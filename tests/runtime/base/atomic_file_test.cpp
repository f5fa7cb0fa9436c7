#include "runtime/base/atomic_file.hpp"

#include <csignal>
#include <fstream>
#include <iterator>
#include <utility>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
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
  const auto no_files_there = AtomicFile::open("/proc/lambent-file");
  ASSERT_FALSE(no_files_there);
  EXPECT_NE(no_files_there.error().problem.find("cannot be written"), std::string::npos);
}

// A limit on the size of files fails writes as a full disk does, in the middle.
TEST_F(AtomicFileTest, KeepsTheOldFileWhereTheDiskIsFull) {
  ::rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  ::rlimit full = before;
  full.rlim_cur = 4096;
  auto* const handled = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
  Result<void> written;
  {
    auto file = AtomicFile::open(folder_ / "file");
    ASSERT_TRUE(file);
    written = file->write(std::string(65536, 'x'));
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handled);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().line(), (folder_ / "file").string() +
                                        ": cannot be written: File too large; free some space or choose "
                                        "another place");
  EXPECT_EQ(*readTextFile(folder_ / "file"), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFileTest, RemovesWhatKilledProgramsLeftAndNothingElse) {
  const ::pid_t gone = ::fork();
  if (gone == 0) ::_exit(0);
  ASSERT_EQ(::waitpid(gone, nullptr, 0), gone);
  const auto part = [&](const std::string& name, ::pid_t writer) {
    const fs::path path = folder_ / (name + ".part-" + std::to_string(writer));
    std::ofstream(path) << "half";
    return path;
  };
  const fs::path abandoned = part("file", gone), in_use = part("file", ::getppid()),
                 of_another = part("other-file", gone), of_no_process = folder_ / "file.part-two";
  std::ofstream(of_no_process) << "mine";
  EXPECT_TRUE(AtomicFile::open(folder_ / "file"));
  EXPECT_FALSE(fs::exists(abandoned));
  EXPECT_TRUE(fs::exists(in_use));
  EXPECT_TRUE(fs::exists(of_another));
  EXPECT_TRUE(fs::exists(of_no_process));
}

TEST_F(AtomicFileTest, DoesNotWaitForAPipe) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(readTextFile(folder_ / "pipe").error().problem, "is a device or a pipe");
}

}  // namespace
}  // namespace lambent
