#include "runtime/base/lower_case.hpp"

#include <gtest/gtest.h>

namespace lambent {

TEST(LowerCase, FoldsAsciiLettersAndLeavesTheBytesOfOthers) {
  EXPECT_EQ(lowerCase("Hall.HDR"), "hall.hdr");
  EXPECT_EQ(lowerCase("@[`{"), "@[`{") << "the neighbours of the letters";
  EXPECT_EQ(lowerCase("\xC3\x84 \xC3\xA4"), "\xC3\x84 \xC3\xA4") << "UTF-8 stays whole";
  EXPECT_EQ(lowerCase(""), "");
}

}  // namespace lambent
