// Decides what becomes of a test that lacks something which not every machine has: an OpenGL context, the
// shared data, a validator. It skips with a sentence, unless the environment variable LAMBENT_REQUIRE names
// the thing (LAMBENT_REQUIRE=gl,data): there it must not be missing, and the test fails. scripts/test names
// what it installs, so that a context which a bug of ours keeps from being made does not pass as a skip.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace lambent::testing {

// Returns whether the list, separated by commas, names the thing.
inline bool names(std::string_view list, std::string_view thing) {
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    if (list.substr(begin, end - begin) == thing) return true;
    begin = end + 1;
  }
  return false;
}

inline bool isRequired(std::string_view thing) {
  const char* list = std::getenv("LAMBENT_REQUIRE");
  return list && names(list, thing);
}

}  // namespace lambent::testing

// Ends the calling TEST or SetUp(): it fails if the thing ("gl", "data", "display", "schema", "python", "validator") is
// required here, else it skips. The message says what is missing and may be streamed: "no " << path.
#define LAMBENT_LACKS(thing, message)                                                               \
  do {                                                                                              \
    if (::lambent::testing::isRequired(thing)) FAIL() << message << "; LAMBENT_REQUIRE has " thing; \
    GTEST_SKIP() << message;                                                                        \
  } while (false)
