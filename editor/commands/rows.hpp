// Declares the parts of the command list and how their rows are made. Each part has a file of its own;
// command_list.cpp joins them.
#pragma once

#include <array>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "editor/commands/command.hpp"
#include "editor/session/session.hpp"

namespace lambent::editor {

std::vector<Command> fileCommands();
std::vector<Command> editCommands();
std::vector<Command> createCommands();
std::vector<Command> viewCommands();
std::vector<Command> windowCommands();
std::vector<Command> lightCommands();
std::vector<Command> bakeCommands();
std::vector<Command> stateCommands();  // commands by which scripts ask about the editor's state

using Answer = Result<nlohmann::json>;

inline constexpr std::array kModes = {"move", "turn", "scale"};  // in the order of GizmoMode

// Makes a command of a function of the session and, if it takes any, words. The function returns a JSON
// value, whether it failed, or nothing.
template <typename Function>
Command item(const char* id, const char* title, const char* shortcut, const char* help, Function function) {
  Command command{.id = id, .title = title, .shortcut = shortcut, .help = help};
  command.run = [function](Session& session, Words words) -> Answer {
    const auto call = [&] {
      if constexpr (std::is_invocable_v<Function, Session&, Words>)
        return function(session, words);
      else
        return function(session);
    };
    using Returned = decltype(call());
    if constexpr (std::is_void_v<Returned>) {
      call();
      return nullptr;
    } else if constexpr (std::is_same_v<Returned, Result<void>>) {
      if (const auto done = call(); !done) return failAgain(done.error());
      return nullptr;
    } else {
      return call();
    }
  };
  return command;
}

// Makes a menu item that switches what `flag` returns a reference to.
template <typename Flag>
Command toggle(const char* id, const char* title, const char* shortcut, const char* help, Flag flag) {
  return item(id, title, shortcut, help,
              [flag](Session& session) {
                flag(session) = !flag(session);
                session.viewing.changed = true;
              })
      .checkedIf([flag](const Session& session) { return flag(session); });
}

// Makes a command for scripts only, without menu item and shortcut.
template <typename Function>
Command scripted(const char* id, const char* help, const char* arguments, std::size_t least, std::size_t most,
                 Function function) {
  return item(id, "", "", help, function).taking(arguments, least, most);
}

inline Command separator() {
  return {.id = "", .title = "-", .shortcut = "", .help = ""};
}

// Puts the rows that have a title into a menu.
inline std::vector<Command> inMenu(const char* menu, std::vector<Command> rows) {
  for (Command& row : rows)
    if (*row.title != '\0') row.menu = menu;
  return rows;
}

// Returns an empty word where there are fewer.
inline std::string wordAt(Words words, std::size_t index) {
  return index < words.size() ? words[index] : std::string();
}

inline bool anyOpen(const Session& session) {
  return !session.scenes.entries().empty();
}

}  // namespace lambent::editor
