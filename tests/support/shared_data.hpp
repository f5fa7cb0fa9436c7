// Where tests find the models and probes that the project does not ship. They lie in ../shared/data beside
// the checkout, or where LAMBENT_SHARED_DATA points; a test that needs them skips with a sentence where they
// are absent.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace lambent::testing {

inline std::filesystem::path sharedData() {
  if (const char* set = std::getenv("LAMBENT_SHARED_DATA")) return set;
  return std::filesystem::path(LAMBENT_SOURCE_DIR) / ".." / "shared" / "data";
}

inline std::filesystem::path sharedFile(const std::string& name) {
  return sharedData() / name;
}

}  // namespace lambent::testing

// Inside a TEST: leaves it, with the reason, where the file is not there.
#define LAMBENT_NEEDS_SHARED(path)    \
  if (!std::filesystem::exists(path)) \
  GTEST_SKIP() << (path) << " is not here; set LAMBENT_SHARED_DATA to the folder with models/ and probes/"
