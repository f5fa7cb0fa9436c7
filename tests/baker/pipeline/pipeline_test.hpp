// Provides a folder for each test.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "assets/scenes.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::testing {

class PipelineTest : public ::testing::Test {
 protected:
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

  const TemporaryFolder own_folder;
  const std::filesystem::path folder = own_folder.path();
};

}  // namespace lambent::testing
