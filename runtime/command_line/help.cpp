#include "runtime/command_line/help.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>
#include <sstream>
#include <vector>

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

}  // namespace

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

namespace {

constexpr std::size_t kColumn = 30, kWidth = 100;

// Writes descriptions in lines that fit, whatever their breaks in the source, and types without what the
// library adds to them.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool positional) const override {
    std::string name = option->get_name(positional, /*all_options=*/!positional);
    std::string help = oneParagraph(option->get_description());
    if (positional) {
      if (option->get_items_expected_max() >= CLI::detail::expected_max_vector_size) name += "...";
    } else if (option->get_type_size() != 0) {
      const std::string type = option->get_type_name();
      name += " " + type.substr(0, type.find(':'));
      if (const std::string range = rangeOf(type); !range.empty()) help += "; " + range;
    }
    if (!option->get_default_str().empty()) name += "=" + option->get_default_str();
    if (option->get_required()) name += " (required)";
    return row(name, help);
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

}  // namespace

CLI::Option* addWords(CLI::App& app, const std::string& names, std::vector<std::string>& words,
                      const std::string& type, const std::string& help) {
  return app.add_option(names, words, help)->type_name(type)->take_all()->expected(1);
}

CLI::Option* addBytes(CLI::App& app, const std::string& names, std::uint64_t& bytes,
                      const std::string& help) {
  return app.add_option(names, bytes, help)
      ->type_name("BYTES")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false));
}

CLI::Option* addWord(CLI::App& app, const std::string& names, const std::string& type,
                     const std::string& help, std::function<Result<void>(const std::string& word)> take) {
  const auto checked = [take = std::move(take)](const std::string& word) {
    if (const Result<void> taken = take(word); !taken) throw CLI::ValidationError(taken.error().line());
  };
  return app.add_option_function<std::string>(names, checked, help)->type_name(type);
}

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
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    finish(*command, version);
}

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

// Returns what to print for an error that `app` threw while it parsed.
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

}  // namespace

std::optional<int> parse(CLI::App& app, int argc, const char* const* argv) {
  constexpr int kWrongUsage = 2;
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);  // --help, --version
  } catch (const CLI::ParseError& wrong) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), usageError(app, wrong).line());
    return kWrongUsage;
  }
  return std::nullopt;
}

}  // namespace lambent::command_line
