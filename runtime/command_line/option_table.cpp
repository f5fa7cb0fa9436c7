#include "runtime/command_line/option_table.hpp"

#include <algorithm>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace lambent::command_line {

namespace {

std::string oneParagraph(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  for (std::string word; in >> word;) out += (out.empty() ? "" : " ") + word;
  return out;
}

// The library adds to the name of a type what its checks say: "S:FLOAT in [0.05 - 600]". Returns a range as
// "0.05..600", and nothing for checks of another kind.
std::string rangeOf(const std::string& type) {
  const std::size_t from = type.find(" in ["), to = type.find(']', from);
  if (from == std::string::npos || to == std::string::npos) return {};
  std::string range = type.substr(from + 5, to - from - 5);
  if (const std::size_t dash = range.find(" - "); dash != std::string::npos) range.replace(dash, 3, "..");
  return range;
}

std::size_t letters(const std::string& utf8) {
  return static_cast<std::size_t>(
      std::ranges::count_if(utf8, [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

CommandEntry commandEntry(const CLI::App& app, const std::string& program) {
  CommandEntry entry{.name = app.get_name(),
                     .program = program,
                     .help = oneParagraph(app.get_description()),
                     .footer = app.get_footer(),
                     .options = {},
                     .commands = {}};
  for (const CLI::Option* option :
       app.get_options([](const CLI::Option* o) { return !o->get_group().empty(); }))
    entry.options.push_back(entryOf(*option));
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    entry.commands.push_back(commandEntry(*command, program + " " + command->get_name()));
  return entry;
}

}  // namespace

std::vector<std::string> OptionEntry::words() const {
  std::vector<std::string> words;
  std::istringstream in(type);
  for (std::string word; std::getline(in, word, '|');)
    if (!word.empty() && std::ranges::all_of(word, [](char c) { return (c >= 'a' && c <= 'z') || c == '-'; }))
      words.push_back(word);
  return words;
}

OptionEntry entryOf(const CLI::Option& option) {
  OptionEntry entry{.group = option.get_group(),
                    .names = {},
                    .argument = {},
                    .type = {},
                    .standard = option.get_default_str(),
                    .help = oneParagraph(option.get_description()),
                    .required = option.get_required()};
  if (option.get_positional()) {
    entry.argument = option.get_name(/*positional=*/true, /*all_options=*/false);
    if (option.get_items_expected_max() >= CLI::detail::expected_max_vector_size) entry.argument += "...";
    return entry;
  }
  for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  if (option.get_type_size() != 0) {
    const std::string type = option.get_type_name();
    entry.type = type.substr(0, type.find(':'));
    if (const std::string range = rangeOf(type); !range.empty()) entry.help += "; " + range;
  }
  return entry;
}

CommandEntry tableOf(const CLI::App& app) {
  std::string program = app.get_name();
  for (const CLI::App* parent = app.get_parent(); parent; parent = parent->get_parent())
    program = parent->get_name() + " " + program;
  return commandEntry(app, program);
}

std::string wrapped(const std::string& words, std::size_t width) {
  std::istringstream in(words);
  std::string text;
  std::size_t line = 0;
  for (std::string word; in >> word;) {
    const std::size_t size = letters(word);
    const bool breaks = line > 0 && line + 1 + size > width;
    text += (breaks ? "\n" : line > 0 ? " " : "") + word;
    line = breaks || line == 0 ? size : line + 1 + size;
  }
  return text;
}

}  // namespace lambent::command_line
