#include "runtime/command_line/usage_error.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>

namespace lambent::command_line {

namespace {

// Returns how many letters must be added, removed, replaced or swapped with their neighbor.
std::size_t lettersApart(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before2, before(b.size() + 1), row(b.size() + 1);
  std::iota(before.begin(), before.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({before[j] + 1, row[j - 1] + 1, before[j - 1] + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before2[j - 2] + 1);
    }
    before2 = before;
    before = row;
  }
  return before.back();
}

// Returns the name that the word was most likely meant to be.
std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& names) {
  std::size_t least = 2 + word.size() / 6;  // a word that differs by so much is another word
  std::optional<std::string> best;
  for (const std::string& name : names)
    if (const std::size_t apart = lettersApart(word, name); apart < least) {
      least = apart;
      best = name;
    }
  return best;
}

std::vector<std::string> optionNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames())
      if (!option->get_group().empty()) names.push_back("--" + name);  // others are hidden
  return names;
}

std::vector<std::string> commandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

}  // namespace

Error usageError(const CLI::App& app, const CLI::ParseError& wrong) {
  const CLI::App* command = &app;  // the one that was chosen
  std::string program = app.get_name();
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    program += " " + command->get_name();
  }
  const std::string help = "see " + program + " --help";
  const auto unknown = [&](const std::string& word, const char* what, const std::vector<std::string>& names) {
    const auto meant = nearest(word, names);
    return Error{word, what, meant ? "did you mean " + *meant + "? Else " + help : help};
  };
  const std::vector<std::string> extra = app.remaining(/*recurse=*/true);
  const auto option = std::ranges::find_if(extra, [](const std::string& w) { return w.starts_with('-'); });
  const bool unexpected = wrong.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError);
  if (unexpected && option != extra.end())
    return unknown(option->substr(0, option->find('=')), "is not an option", optionNames(*command));
  if (command == &app && !extra.empty() && !commandNames(app).empty())
    return unknown(extra.front(), "is not a command", commandNames(app));
  if (unexpected && !extra.empty()) return {extra.front(), "is one word too many", help};
  const std::string text = wrong.what();
  return {{}, text, text.find("; ") == std::string::npos ? help : ""};  // else it says what to do
}

}  // namespace lambent::command_line
