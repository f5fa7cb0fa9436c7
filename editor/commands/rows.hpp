// Declares the parts of the command list. Each part has a file of its own; command_list.cpp joins them.
#pragma once

#include <array>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/session/names.hpp"
#include "editor/session/session.hpp"

namespace lambent::editor {

std::span<const Command> fileCommands();
std::span<const Command> editCommands();
std::span<const Command> createCommands();
std::span<const Command> viewCommands();
std::span<const Command> handleCommands();
std::span<const Command> cameraCommands();
std::span<const Command> layoutCommands();
std::span<const Command> lightCommands();
std::span<const Command> bakeCommands();
std::span<const Command> stateCommands();  // commands by which scripts ask about the editor's state

using Answer = Result<nlohmann::json>;

inline constexpr std::array kPivots = {"primary", "center", "each"};  // in the order of GizmoPivot

// Makes a separator line in a menu.
constexpr Command separator(const char* menu) {
  return {.id = "", .title = "-", .menu = menu, .shortcut = "", .help = "", .arguments = ""};
}

// Makes a menu item.
constexpr Command item(const char* menu, const char* id, const char* title, const char* shortcut,
                       const char* help, Answer (*run)(Session&, Words)) {
  return {.id = id,
          .title = title,
          .menu = menu,
          .shortcut = shortcut,
          .help = help,
          .arguments = "",
          .run = run};
}

// Makes a menu item that is checked while `is` says so.
constexpr Command toggle(bool (*is)(const Session&), Command command) {
  command.checked = is;
  return command;
}

// Makes a command that can be run only while `is` says so.
constexpr Command enabled(bool (*is)(const Session&), Command command) {
  command.enabled = is;
  return command;
}

// Makes a command that takes words.
constexpr Command withWords(const char* arguments, std::size_t least, std::size_t most, Command command) {
  command.arguments = arguments, command.least_words = least, command.most_words = most;
  return command;
}

// Makes a command for scripts only, without menu item and shortcut.
constexpr Command scripted(const char* id, const char* help, const char* arguments, std::size_t least,
                           std::size_t most, Answer (*run)(Session&, Words)) {
  return withWords(arguments, least, most, item("Script", id, "", "", help, run));
}

// Also accepts the id that the command had before version 0.11.
constexpr Command formerly(const char* id, Command command) {
  command.former = id;
  return command;
}

inline bool anyOpen(const Session& session) {
  return !session.scenes.entries().empty();
}

inline Answer answerOf(const Result<void>& done, nlohmann::json answer = nullptr) {
  if (!done) return failAgain(done.error());
  return answer;
}

}  // namespace lambent::editor
