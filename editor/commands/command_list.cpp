#include <array>
#include <cctype>
#include <string>
#include <utility>

#include "editor/commands/rows.hpp"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

namespace lambent::editor {

Command Command::taking(const char* words, std::size_t least, std::size_t most) const {
  Command command = *this;
  command.arguments = words, command.least_words = least, command.most_words = most;
  return command;
}
Command Command::onlyIf(std::function<bool(const Session&)> is) const {
  Command command = *this;
  command.enabled = std::move(is);
  return command;
}
Command Command::checkedIf(std::function<bool(const Session&)> is) const {
  Command command = *this;
  command.checked = std::move(is);
  return command;
}

std::span<const Command> commandList() {
  static const std::vector<Command> list = [] {
    std::vector<Command> all;
    for (const auto& rows : {fileCommands(), editCommands(), createCommands(), viewCommands(),
                             lightCommands(), bakeCommands(), windowCommands(), stateCommands()})
      all.insert(all.end(), rows.begin(), rows.end());
    return all;
  }();
  return list;
}

const Command* findCommand(std::string_view id) {
  for (const Command& command : commandList())
    if (!id.empty() && id == command.id) return &command;
  return nullptr;
}

Result<nlohmann::json> runCommand(Session& session, std::string_view id, Words words) {
  const Command* command = findCommand(id);
  if (!command) return fail(std::string(id), "is no command", "\"commands\" lists them");
  if (words.size() < command->least_words && *command->title == '\0')
    return fail(std::string(id), "needs more words", fmt::format("{} {}", command->id, command->arguments));
  if (words.size() > command->most_words)
    return fail(std::string(id), "has too many words", fmt::format("{} {}", command->id, command->arguments));
  if (command->enabled && !command->enabled(session))
    return fail(std::string(id), "cannot be done now", command->help);
  try {
    return command->run(session, words);
  } catch (const std::exception& failure) {  // out of memory, mostly
    return fail(std::string(id), failure.what(), "");
  }
}

void runOrLog(Session& session, std::string_view id, Words words) {
  if (const auto done = runCommand(session, id, words); !done) session.log.error(done.error());
}

namespace {

constexpr std::array kNamed = {
    std::pair{"Delete", GLFW_KEY_DELETE}, std::pair{"Escape", GLFW_KEY_ESCAPE},
    std::pair{"Space", GLFW_KEY_SPACE},   std::pair{"Enter", GLFW_KEY_ENTER},
    std::pair{"Tab", GLFW_KEY_TAB},       std::pair{"Home", GLFW_KEY_HOME},
    std::pair{"Left", GLFW_KEY_LEFT},     std::pair{"Right", GLFW_KEY_RIGHT},
    std::pair{"Up", GLFW_KEY_UP},         std::pair{"Down", GLFW_KEY_DOWN},
    std::pair{",", GLFW_KEY_COMMA},       std::pair{"Backspace", GLFW_KEY_BACKSPACE}};

int keyOf(std::string_view name) {
  for (const auto& [word, key] : kNamed)
    if (name == word) return key;
  if (name.size() == 1 && std::isalnum(static_cast<unsigned char>(name[0])))
    return std::toupper(static_cast<unsigned char>(name[0]));  // GLFW's keys are ASCII there
  if (name.size() >= 2 && name[0] == 'F' && name.find_first_not_of("0123456789", 1) == name.npos) {
    const int number = std::stoi(std::string(name.substr(1, 2)));
    if (number >= 1 && number <= 12) return GLFW_KEY_F1 + number - 1;
  }
  return -1;
}

}  // namespace

Result<Shortcut> parseShortcut(std::string_view text) {
  Shortcut shortcut;
  std::string_view rest = text;
  const auto takes = [&](std::string_view modifier) {
    if (!rest.starts_with(modifier)) return false;
    rest.remove_prefix(modifier.size());
    return true;
  };
  for (bool any = true; any;) {
    any = false;
    if (takes("Ctrl+")) any = shortcut.ctrl = true;
    if (takes("Shift+")) any = shortcut.shift = true;
    if (takes("Alt+")) any = shortcut.alt = true;
  }
  shortcut.key = keyOf(rest);
  if (shortcut.key >= 0) return shortcut;
  return fail("key", fmt::format("\"{}\" is not known", text), "give keys like Ctrl+Shift+S, F5 or Delete");
}

}  // namespace lambent::editor
