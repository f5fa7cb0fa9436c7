// The room runtime/command_line says what the options of a program are, in every form from one table: --help,
// manual pages, completion in shells, and what was meant where a word is wrong. The table is read from the
// CLI::App that parses the options, so nothing is written twice. Programs call addExamples() and finish()
// when their options are declared. All functions run on the main thread before any work begins.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace CLI {

class App;
class Option;
class ParseError;

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

struct Example {
  std::string command;  // as "lambent bake scene.gltf"
  std::string says;     // what it does, in a few words
};

// Sets what --help ends with: a paragraph of notes, if there is one, the examples and the exit codes.
void addExamples(CLI::App& app, const std::vector<Example>& examples, const std::string& notes = {});

// Puts options under a heading of --help.
void group(CLI::App& app, const std::string& heading, const std::vector<std::string>& options);

// Completes the command line of a program when all its options and subcommands are declared. It gets the
// hidden option --help-as, with which the package makes manual pages and completions (cmake/package), in each
// subcommand too.
void finish(CLI::App& app, const std::string& version);

// Parses a command line. Returns nothing if the program is to go on, or else its exit code: 0 after --help
// and
// --version, 2 after one line on stderr that says what is wrong. A word that is not known is named with the
// nearest one that is.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

// Writes functions with which shells complete the words of a command line.
std::string bashCompletion(const CommandEntry& table);
std::string zshCompletion(const CommandEntry& table);
std::string fishCompletion(const CommandEntry& table);

// Writes a manual page for man(1).

// `version` is what --version prints, as "lambent 1.2". The page bears the date of SOURCE_DATE_EPOCH, which
// reproducible builds set (reproducible-builds.org/specs/source-date-epoch), or else of today.
std::string manualPage(const CommandEntry& table, const std::string& version);

}  // namespace lambent::command_line
