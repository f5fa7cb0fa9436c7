// Gives programs their --help: options in groups, lines that fit a terminal, then examples and exit codes.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace lambent::command_line {

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

}  // namespace lambent::command_line
