// Adds the options of a bake to the command line. The library parses the words, and the table of options says
// what they mean.
#include <string>

#include <CLI/CLI.hpp>

#include "baker/bake/option_rows.hpp"
#include "baker/cli/commands.hpp"

namespace lambent::baker {

namespace {

CLI::Option* add(CLI::App& command, std::string_view name, const OptionRow& row, BakeOptions& options) {
  CLI::Option* option = command.add_option_function<std::string>(
      "--" + std::string(name), [&options, &row](const std::string& word) { row.put(options, word); },
      row.help);
  option->type_name(std::string(row.kind))->group(std::string(row.group));
  option->check(CLI::Validator(
      [&row](const std::string& word) {
        BakeOptions tried;
        const auto put = row.put(tried, word);
        return put ? std::string() : put.error().problem + "; " + put.error().hint;
      },
      ""));
  return option;
}

void add(CLI::App& command, const OptionRow& row, BakeOptions& options) {
  CLI::Option* option = add(command, row.name, row, options);
  if (row.shows_default) option->default_str(row.word(BakeOptions{}));
  if (!row.former.empty()) add(command, row.former, row, options)->group("");  // hidden in the help
}

}  // namespace

void addBakeOptions(CLI::App& command, BakeOptions& options) {
  for (const OptionRow& row : optionRows()) add(command, row, options);
}

}  // namespace lambent::baker
