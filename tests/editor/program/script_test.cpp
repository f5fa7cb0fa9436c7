#include "editor/script/script.hpp"

#include <gtest/gtest.h>

namespace lambent::editor {
namespace {

TEST(EditorScript, WordsArePartedByBlanksAndKeptByQuotes) {
  const auto lines = parseScript("s", "open  \"a b.glb\"\tc\n\n# note\nset \"say \\\"hi\\\"\" \"\" # end\n");
  ASSERT_TRUE(lines.has_value());
  ASSERT_EQ(lines->size(), 2u);
  EXPECT_EQ((*lines)[0].words, (std::vector<std::string>{"open", "a b.glb", "c"}));
  EXPECT_EQ((*lines)[1].words, (std::vector<std::string>{"set", "say \"hi\"", ""}));
  EXPECT_EQ((*lines)[1].number, 4u);
}

TEST(EditorScript, TryMarksALineThatMayFail) {
  const auto lines = parseScript("s", "try open nothing.glb\nundo");
  ASSERT_TRUE(lines.has_value());
  EXPECT_TRUE((*lines)[0].may_fail);
  EXPECT_EQ((*lines)[0].words.front(), "open");
  EXPECT_FALSE((*lines)[1].may_fail);
}

TEST(EditorScript, AnOpenQuoteIsAnErrorWithItsLine) {
  const auto lines = parseScript("my.script", "undo\nopen \"a b\n");
  ASSERT_FALSE(lines.has_value());
  EXPECT_EQ(lines.error().subject, "my.script:2");
}

}  // namespace
}  // namespace lambent::editor
