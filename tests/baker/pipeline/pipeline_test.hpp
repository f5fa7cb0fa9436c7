// Provides a folder for each test.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "assets/scenes.hpp"
#include "tests/support/eventually.hpp"

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

  std::filesystem::path folder;
};

}  // namespace lambent::testing
