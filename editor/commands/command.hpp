// Lists everything that the editor can do as rows: menus, shortcuts, tooltips and scripts all go by
// it. A command takes words and gives an answer, a JSON value, or an error that says what to do; from the
// menu it has no words, and those that need some ask for them in a dialog.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "runtime/base/result.hpp"

namespace lambent::editor {

class Session;

using Words = std::span<const std::string>;

struct Command {
  const char* id;         // of scripts: "save"
  const char* title;      // of menus: "Save world"; empty: for scripts only
  const char* menu;       // "File"
  const char* shortcut;   // "Ctrl+Shift+S"; empty: none
  const char* help;       // a sentence
  const char* arguments;  // "FILE [OPTION]"; empty: none
  std::size_t least_words = 0, most_words = 0;
  Result<nlohmann::json> (*run)(Session& session, Words words) = nullptr;
  bool (*enabled)(const Session& session) = nullptr;  // null: always
  bool (*checked)(const Session& session) = nullptr;  // null: no switch
  const char* former = "";  // the id before 0.11, which is still understood but not shown; may be empty
};

// Returns the rows in the order of menus.
std::span<const Command> commandList();
// Finds a command by its id or its former one; null: there is none.
const Command* findCommand(std::string_view id);

// Runs it if it is enabled and has as many words as it takes; what goes wrong is an error here, and nothing
// is thrown.
Result<nlohmann::json> runCommand(Session& session, std::string_view id, Words words);

// Holds "Ctrl+Shift+S" as keys.
struct Shortcut {
  int key = -1;  // of GLFW
  bool ctrl = false, shift = false, alt = false;
  bool operator==(const Shortcut&) const = default;
};
Result<Shortcut> parseShortcut(std::string_view text);

}  // namespace lambent::editor
