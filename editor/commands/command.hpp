// Lists everything that the editor can do as commands; menus, shortcuts, tooltips and scripts all use this
// list. A command takes words and returns a JSON value, or an error that says what to do. The menu passes no
// words, and a command that needs some then opens a dialog to ask for them.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "runtime/base/result.hpp"

namespace lambent::editor {

class Session;

using Words = std::span<const std::string>;

struct Command {
  const char* id;               // the name in scripts: "save"; empty: a separator of the menu
  const char* title;            // the text in menus: "Save world"; empty: the command is for scripts only
  const char* shortcut;         // "Ctrl+Shift+S"; empty: none
  const char* help;             // a sentence for tooltips and lists
  const char* menu = "Script";  // the menu that shows it: "File"
  const char* arguments = "";   // "FILE [OPTION]"; empty: none
  std::size_t least_words = 0, most_words = 0;
  std::function<Result<nlohmann::json>(Session& session, Words words)> run{};
  std::function<bool(const Session& session)> enabled{};  // none: always enabled
  std::function<bool(const Session& session)> checked{};  // state of a switch; none: no switch

  // Make a command that takes words, that can be run only while `is` says so, or that is checked then.
  Command taking(const char* words, std::size_t least, std::size_t most) const;
  Command onlyIf(std::function<bool(const Session&)> is) const;
  Command checkedIf(std::function<bool(const Session&)> is) const;
};

// Returns the commands in the order in which menus show them.
std::span<const Command> commandList();
// Returns null if there is none of that id.
const Command* findCommand(std::string_view id);

// Runs the command. Errors: it does not exist, is not enabled, takes another number of words, or failed.
// Nothing is thrown.
Result<nlohmann::json> runCommand(Session& session, std::string_view id, Words words);
// Runs the command for a widget: errors go to the log, and the answer is dropped.
void runOrLog(Session& session, std::string_view id, Words words);

// Holds a shortcut such as "Ctrl+Shift+S".
struct Shortcut {
  int key = -1;  // a GLFW key code
  bool ctrl = false, shift = false, alt = false;
  bool operator==(const Shortcut&) const = default;
};
Result<Shortcut> parseShortcut(std::string_view text);

}  // namespace lambent::editor
