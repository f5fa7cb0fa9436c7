#include "runtime/base/result.hpp"

#include <gtest/gtest.h>

namespace lambent {
namespace {

TEST(Error, IsOneLineThatNamesTheThingTheProblemAndTheMend) {
  EXPECT_EQ((Error{"a.glb", "is truncated", "copy it again"}).line(), "a.glb: is truncated; copy it again");
  EXPECT_EQ((Error{"a.glb", "stopped", ""}).line(), "a.glb: stopped");
  EXPECT_EQ((Error{"", "no device", "install a driver"}).line(), "no device; install a driver");
  EXPECT_EQ((Error{"a\nb", "said\r\nno", ""}).line(), "a b: said  no");
}

}  // namespace
}  // namespace lambent
