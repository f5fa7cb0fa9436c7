#include "runtime/base/result.hpp"

#include <gtest/gtest.h>

#include "runtime/base/lower_case.hpp"

namespace lambent {
namespace {

TEST(Error, IsOneLineThatNamesTheThingTheProblemAndTheMend) {
  EXPECT_EQ((Error{"a.glb", "is truncated", "copy it again"}).line(), "a.glb: is truncated; copy it again");
  EXPECT_EQ((Error{"a.glb", "stopped", ""}).line(), "a.glb: stopped");
  EXPECT_EQ((Error{"", "no device", "install a driver"}).line(), "no device; install a driver");
  EXPECT_EQ((Error{"a\x1b[31mb\x1b[0m", "says\tno\x07", ""}).line(), "ab: says no ");
  const std::string long_name = (Error{"", std::string(5000, 'x'), "export it again"}).line();
  EXPECT_LT(long_name.size(), 600u);
  EXPECT_TRUE(long_name.ends_with("x...; export it again")) << long_name;
  EXPECT_EQ((Error{"a\nb", "said\r\nno", ""}).line(), "a b: said  no");
}

TEST(Error, IsUtf8WhateverBytesAFilesNamesHave) {
  EXPECT_EQ((Error{"caf\xc3\xa9", "grid \xe2\x82\xac \xf0\x9f\x92\xa1", ""}).line(),
            "caf\xc3\xa9: grid \xe2\x82\xac \xf0\x9f\x92\xa1");
  EXPECT_EQ((Error{"", "\xff\xc0 \x80 \xc3", ""}).line(), "?? ? ?");
  EXPECT_EQ((Error{"", "\xe2\x82", ""}).line(), "??");
}

TEST(LowerCase, FoldsAsciiLettersAndLeavesTheBytesOfOthers) {
  EXPECT_EQ(lowerCase("Hall.HDR"), "hall.hdr");
  EXPECT_EQ(lowerCase("@[`{"), "@[`{") << "the neighbours of the letters";
  EXPECT_EQ(lowerCase("\xC3\x84 \xC3\xA4"), "\xC3\x84 \xC3\xA4") << "UTF-8 stays whole";
  EXPECT_EQ(lowerCase(""), "");
}

}  // namespace
}  // namespace lambent
