#include <string>

#include <gtest/gtest.h>

#include "editor/document/field_edits.hpp"

namespace lambent::editor {
namespace {

// Returns what the typed text makes of 10.
double ofTen(std::string_view text) {
  const auto edit = parseNumberEdit(text);
  EXPECT_TRUE(edit) << text;
  return edit ? edit->appliedTo(10.0) : -1.0;
}

TEST(NumberEdit, CalculatesWhatIsTyped) {
  EXPECT_EQ(ofTen("2.5"), 2.5);
  EXPECT_EQ(ofTen("-3"), -3.0) << "a number, not a difference";
  EXPECT_EQ(ofTen(" 2*3 + 1 "), 7.0);
  EXPECT_EQ(ofTen("1+2*3"), 7.0);
  EXPECT_EQ(ofTen("(1+2)*-3"), -9.0);
  EXPECT_EQ(ofTen("1e2/4"), 25.0);
}

TEST(NumberEdit, ShiftsAndScalesTheNumberThatIsThere) {
  EXPECT_EQ(ofTen("+=1"), 11.0);
  EXPECT_EQ(ofTen("-= 2*2"), 6.0);
  EXPECT_EQ(ofTen("*2"), 20.0);
  EXPECT_EQ(ofTen("*=1.5"), 15.0);
  EXPECT_EQ(ofTen("/4"), 2.5);
}

TEST(NumberEdit, RefusesWhatHasNoFiniteResult) {
  for (const char* text : {"", " ", "2*", "two", "1/0", "/0", "nan", "inf", "1e999", "(1", "1)", "+=", "2 3"})
    EXPECT_FALSE(parseNumberEdit(text)) << text;
  EXPECT_FALSE(parseNumberEdit(std::string(100'000, '('))) << "without running out of stack";
}

}  // namespace
}  // namespace lambent::editor
