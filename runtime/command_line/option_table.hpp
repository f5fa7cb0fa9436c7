// The room runtime/command_line says what the options of a program are, in every form from one table: --help,
// manual pages, completion in shells, and what was meant where a word is wrong. The table is read from the
// CLI::App that parses the options, so nothing is written twice. Programs call addExamples() and finish()
// (help.hpp) when their options are declared. All functions run on the main thread before any work begins.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lambent::command_line {

struct OptionEntry {
  std::string group{};               // its heading in --help
  std::vector<std::string> names{};  // "-o", "--output"; none for a positional argument
  std::string argument{};            // of a positional argument, as "SCENE..."
  std::string type{};                // what a value looks like, as "N|auto"; empty for a flag
  std::string standard{};            // the default value; empty if there is none or the help says it
  std::string help{};                // one paragraph
  bool required = false;

  bool takesValue() const { return !type.empty(); }
  std::vector<std::string> words() const;  // that stand in its type, as "auto"
};

struct CommandEntry {
  std::string name{};     // "bake"; of the program itself "lambent"
  std::string program{};  // "lambent bake"
  std::string help{}, footer{};
  std::vector<OptionEntry> options{};  // without hidden ones
  std::vector<CommandEntry> commands{};
};

OptionEntry entryOf(const CLI::Option& option);
CommandEntry tableOf(const CLI::App& app);

// Breaks the words into lines of at most `width` letters.
std::string wrapped(const std::string& words, std::size_t width);

}  // namespace lambent::command_line
