#include <map>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/script/script.hpp"
#include "runtime/base/atomic_file.hpp"

namespace lambent::editor {
namespace {

TEST(EditorCommands, HaveNamesOfTheirOwnAndSayWhatTheyDo) {
  std::set<std::string> ids;
  for (const Command& command : commandList()) {
    if (*command.id == '\0') continue;
    EXPECT_TRUE(ids.insert(command.id).second) << command.id;
    EXPECT_GT(std::string(command.help).size(), 5u) << command.id;
    EXPECT_TRUE(command.run) << command.id;
    EXPECT_LE(command.least_words, command.most_words) << command.id;
  }
  EXPECT_GT(ids.size(), 60u);
}

TEST(EditorCommands, HaveShortcutsThatAreKeysAndNeverTheSame) {
  std::map<std::string, std::string> taken;
  for (const Command& command : commandList()) {
    if (*command.shortcut == '\0') continue;
    EXPECT_TRUE(parseShortcut(command.shortcut).has_value()) << command.shortcut;
    const auto [place, fresh] = taken.emplace(command.shortcut, command.id);
    EXPECT_TRUE(fresh) << command.id << " and " << place->second;
  }
}

TEST(EditorCommands, ShortcutsThatAreNoneAreErrors) {
  for (const char* text : {"", "Ctrl+", "Hyper+A", "F13", "Ctrl+Nothing"})
    EXPECT_FALSE(parseShortcut(text).has_value()) << text;
}

TEST(EditorCommands, AreAllInTheManual) {
  const auto manual = readTextFile(LAMBENT_SOURCE_DIR "/docs/editor.md");
  ASSERT_TRUE(manual.has_value());
  for (const Command& command : commandList()) {
    if (*command.id == '\0') continue;
    EXPECT_NE(manual->find(std::string("`").append(command.id)), std::string::npos) << command.id;
  }
}

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
