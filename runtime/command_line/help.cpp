#include "runtime/command_line/help.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "runtime/command_line/completion.hpp"
#include "runtime/command_line/manual_page.hpp"
#include "runtime/command_line/option_table.hpp"

namespace lambent::command_line {

namespace {

constexpr std::size_t kColumn = 30, kWidth = 100;

// Writes descriptions in lines that fit, whatever their breaks in the source, and types without what the
// library adds to them.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool positional) const override {
    const OptionEntry entry = entryOf(*option);
    std::string name = positional ? entry.argument : fmt::format("{}", fmt::join(entry.names, ","));
    if (!positional && entry.takesValue()) name += " " + entry.type;
    if (!entry.standard.empty()) name += "=" + entry.standard;
    if (entry.required) name += " (required)";
    return row(name, entry.help);
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return row(command->get_name(), command->get_description());
  }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    // The library writes two empty lines between groups.
    return CLI::detail::find_and_replace(CLI::Formatter::make_help(app, std::move(name), mode), "\n\n\n",
                                         "\n\n");
  }

 private:
  static std::string row(const std::string& name, const std::string& help) {
    std::stringstream out;
    CLI::detail::format_help(out, name, wrapped(help, kWidth - kColumn), kColumn);
    return out.str();
  }
};

std::string commandList(const CommandEntry& table) {
  std::string names;
  for (const CommandEntry& command : table.commands) names += (names.empty() ? "" : "\n") + command.name;
  return names;
}

using Form = std::string (*)(const CommandEntry&, const std::string& version);
const std::map<std::string, Form>& forms() {
  static const std::map<std::string, Form> kForms = {
      {"man", [](const CommandEntry& t, const std::string& version) { return manualPage(t, version); }},
      {"bash", [](const CommandEntry& t, const std::string&) { return bashCompletion(t); }},
      {"zsh", [](const CommandEntry& t, const std::string&) { return zshCompletion(t); }},
      {"fish", [](const CommandEntry& t, const std::string&) { return fishCompletion(t); }},
      {"commands", [](const CommandEntry& t, const std::string&) { return commandList(t); }}};
  return kForms;
}

}  // namespace

void addExamples(CLI::App& app, const std::vector<Example>& examples, const std::string& notes) {
  std::string footer = notes.empty() ? "" : wrapped(notes, kWidth) + "\n\n";
  if (!examples.empty()) footer += "Examples:\n";
  for (const Example& example : examples)
    footer += fmt::format("  {}\n      {}\n", example.command, example.says);
  if (!examples.empty()) footer += "\n";
  app.footer(footer + "Exit codes:\n  0  done\n  1  failed\n  2  wrong usage");
}

void group(CLI::App& app, const std::string& heading, const std::vector<std::string>& options) {
  for (const std::string& option : options) app.get_option(option)->group(heading);
}

void finish(CLI::App& app, const std::string& version) {
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", version, "Print the version and exit");
  app.set_help_flag("-h,--help", "Print this and exit");
  app.add_option_function<std::string>("--help-as",
                                       [&app, version](const std::string& form) {
                                         const auto found = forms().find(form);
                                         if (found == forms().end())
                                           throw CLI::ValidationError(
                                               "--help-as", "takes man, bash, zsh, fish or commands");
                                         // The library prints what this carries, and the program ends with
                                         // exit code 0.
                                         throw CLI::CallForVersion(found->second(tableOf(app), version), 0);
                                       })
      ->group("");  // hidden
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    finish(*command, version);
}

}  // namespace lambent::command_line
