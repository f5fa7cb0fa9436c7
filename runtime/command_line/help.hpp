// The room runtime/command_line says what the options of a program are with --help, and what was meant where
// a word is wrong. Manual pages and completion in bash are made of --help (cmake/package). Programs call
// addExamples() and finish() when their options are declared. All functions run on the main thread before any
// work begins.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace CLI {
class App;
}

namespace lambent::command_line {

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

// Completes the command line of a program when all its options and subcommands are declared.
void finish(CLI::App& app, const std::string& version);

// Parses a command line. Returns nothing if the program is to go on, or else its exit code: 0 after --help
// and --version, 2 after one line on stderr that says what is wrong. A word that is not known is named with
// the nearest one that is.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

}  // namespace lambent::command_line
