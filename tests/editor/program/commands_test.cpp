#include <map>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "runtime/base/atomic_file.hpp"

namespace lambent::editor {
namespace {

TEST(EditorCommands, HaveNamesOfTheirOwnAndSayWhatTheyDo) {
  std::set<std::string> ids;
  for (const Command& command : commandList()) {
    if (*command.id == '\0') continue;
    EXPECT_TRUE(ids.insert(command.id).second) << command.id;
    if (*command.former != '\0') {
      EXPECT_TRUE(ids.insert(command.former).second) << command.former;
    }
    EXPECT_GT(std::string(command.help).size(), 5u) << command.id;
    EXPECT_NE(command.run, nullptr) << command.id;
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

}  // namespace
}  // namespace lambent::editor
