// Provides a folder for each test, and waiting for other threads.
#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "assets/scenes.hpp"

namespace lambent::testing {

class PipelineTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = std::filesystem::path(::testing::TempDir()) /
             fmt::format("{}-{}-{}", ::getpid(), test->test_suite_name(), test->name());
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  static std::string bytesOf(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void writeBytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
  }
  static void write(const std::filesystem::path& path, const assets::Scene& scene) {
    const auto written = assets::writeGlb(path, scene);
    ASSERT_TRUE(written) << written.error().line();
  }
  // Polls `done` until it is true. The timeout is long enough for a busy machine.
  template <typename Done>
  static bool eventually(const Done& done, std::chrono::milliseconds within = std::chrono::seconds(60)) {
    const auto end = std::chrono::steady_clock::now() + within;
    while (!done()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }

  std::filesystem::path folder;
};

}  // namespace lambent::testing
