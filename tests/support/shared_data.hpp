// Finds the models and light probes that the project does not ship. They are in ../shared/data beside the
// checkout, or where LAMBENT_SHARED_DATA points. Tests that need them skip if they are absent, or fail if
// LAMBENT_REQUIRE has data (require.hpp).
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/require.hpp"

namespace lambent::testing {

inline std::filesystem::path sharedData() {
  if (const char* set = std::getenv("LAMBENT_SHARED_DATA")) return set;
  return std::filesystem::path(LAMBENT_SOURCE_DIR) / ".." / "shared" / "data";
}

inline std::filesystem::path sharedFile(const std::string& name) {
  return sharedData() / name;
}

}  // namespace lambent::testing

// Ends the calling TEST, with the reason, if the file does not exist.
#define LAMBENT_NEEDS_SHARED(path)    \
  if (!std::filesystem::exists(path)) \
  LAMBENT_LACKS("data",               \
                (path) << " is not here; set LAMBENT_SHARED_DATA to the folder with models/ and probes/")
