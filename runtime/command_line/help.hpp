// The room runtime/command_line says what the options of a program are with --help, and what was meant where
// a word is wrong. Manual pages and completion in bash are made of --help (cmake/package). Programs call
// addExamples() and finish() when their options are declared. All functions run on the main thread before any
// work begins.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "runtime/base/result.hpp"

namespace lambent::command_line {

// Breaks the words into lines of at most `width` letters.
std::string wrapped(const std::string& words, std::size_t width);

// Adds an option; --help shows `type` where its value stands.
template <class Value>
CLI::Option* addValue(CLI::App& app, const std::string& names, Value& value, const std::string& type,
                      const std::string& help) {
  return app.add_option(names, value, help)->type_name(type);
}
// Adds an option that may be given several times, with a word each.
CLI::Option* addWords(CLI::App& app, const std::string& names, std::vector<std::string>& words,
                      const std::string& type, const std::string& help);
// Adds an option for a number of bytes, which may have a unit of 1024 and its powers: "4GB".
CLI::Option* addBytes(CLI::App& app, const std::string& names, std::uint64_t& bytes, const std::string& help);
// Adds an option whose word `take` understands, or refuses as wrong usage.
CLI::Option* addWord(CLI::App& app, const std::string& names, const std::string& type,
                     const std::string& help, std::function<Result<void>(const std::string& word)> take);

// Returns a function for addWord() that keeps in `value` what `parse` makes of the word.
template <class Value, class Parse>
auto into(Value& value, Parse parse) {
  return [&value, parse](const std::string& word) -> Result<void> {
    auto parsed = parse(word);
    if (!parsed) return failAgain(parsed.error());
    value = std::move(*parsed);
    return {};
  };
}

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
