// Runs a built program as a user does, with arguments in, and the exit code and both output streams out. Each
// test has a folder of its own, which is removed after it.
#pragma once

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lambent::testing {

inline std::string bytesOf(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void writeBytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

struct Outcome {
  int exit_code = -1;  // -1: ended by a signal
  std::string out, err;
};

// Returns whether lambent-demo ended because there is no OpenGL 4.5. Any other failure is a failure of the
// test.
inline bool lacksDevice(const Outcome& outcome) {
  return outcome.exit_code == 1 && outcome.err.find("lambent-demo: OpenGL: ") != std::string::npos;
}

class ProgramTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = std::filesystem::path(::testing::TempDir()) /
             fmt::format("{}-{}-{}", ::getpid(), test->test_suite_name(), test->name());
    std::filesystem::create_directories(folder);
    // Results of other runs must not be reused.
    ::setenv("LAMBENT_CACHE", "off", /*overwrite=*/1);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  ::pid_t start(const std::filesystem::path& program, const std::vector<std::string>& arguments) const {
    std::vector<std::string> words = {program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log("out").c_str(), kFlags, 0600);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, log("err").c_str(), kFlags, 0600);
    ::pid_t id = -1;
    EXPECT_EQ(posix_spawn(&id, program.c_str(), &files, nullptr, argv.data(), environ), 0) << program;
    posix_spawn_file_actions_destroy(&files);
    return id;
  }

  Outcome finish(::pid_t id) const {
    int status = 0;
    EXPECT_EQ(::waitpid(id, &status, 0), id);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, bytesOf(log("out")), bytesOf(log("err"))};
  }

  Outcome run(const std::filesystem::path& program, const std::vector<std::string>& arguments) const {
    return finish(start(program, arguments));
  }

  // Returns the number of files in the folder.
  std::ptrdiff_t fileCount() const {
    return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
  }

  std::filesystem::path folder;

  std::filesystem::path log(const char* name) const {
    return folder.parent_path() / (folder.filename().string() + "." + name);
  }
};

// Expects stderr to be exactly one line "PROGRAM: SUBJECT: PROBLEM[; MEND]".
inline void expectOneLine(const Outcome& outcome, const std::string& program, const std::string& what) {
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << what << "\n" << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with(program + ": ")) << what << "\n" << outcome.err;
  EXPECT_TRUE(outcome.err.ends_with('\n')) << what;
  EXPECT_EQ(outcome.out, "") << what;
}

}  // namespace lambent::testing
