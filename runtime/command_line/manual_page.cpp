#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <sstream>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "runtime/command_line/help.hpp"

namespace lambent::command_line {

namespace {

// In roff a backslash and a line's first dot or quote are commands, and a bare hyphen may be typeset as a
// dash, which nobody could paste.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool first = out.empty() || out.back() == '\n';
    if (first && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else
      out += c == '-' ? std::string("\\-") : std::string(1, c);
  }
  return out;
}

std::string upperCase(std::string word) {
  std::ranges::transform(word, word.begin(),
                         [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return word;
}

std::string dashed(std::string program) {
  std::ranges::replace(program, ' ', '-');
  return program;
}

std::string synopsis(const CommandEntry& table) {
  std::string line = fmt::format("\\fB{}\\fR [\\fIOPTIONS\\fR]", roff(table.program));
  for (const OptionEntry& option : table.options)
    if (!option.argument.empty())
      line += fmt::format(" {}\\fI{}\\fR{}", option.required ? "" : "[", roff(option.argument),
                          option.required ? "" : "]");
  return line + (table.commands.empty() ? "" : " \\fICOMMAND\\fR ...");
}

std::string optionItem(const OptionEntry& option) {
  std::string names = option.argument.empty() ? "" : fmt::format("\\fI{}\\fR", roff(option.argument));
  for (const std::string& name : option.names)
    names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", roff(name));
  if (option.takesValue()) names += fmt::format(" \\fI{}\\fR", roff(option.type));
  const std::string standard = option.standard.empty() ? "" : fmt::format(" (default: {})", option.standard);
  return fmt::format(".TP\n{}\n{}\n", names, roff(option.help + standard));
}

// Writes the options by their groups, in the order in which --help has them.
std::string optionSections(const CommandEntry& table) {
  std::vector<std::string> groups;
  std::string arguments, text;
  for (const OptionEntry& option : table.options) {
    if (!option.argument.empty())
      arguments += optionItem(option);
    else if (std::ranges::find(groups, option.group) == groups.end())
      groups.push_back(option.group);
  }
  if (!arguments.empty()) text += ".SH ARGUMENTS\n" + arguments;
  text += ".SH OPTIONS\n";
  for (const std::string& group : groups) {
    if (groups.size() > 1) text += fmt::format(".SS {}\n", roff(group));
    for (const OptionEntry& option : table.options)
      if (option.argument.empty() && option.group == group) text += optionItem(option);
  }
  return text;
}

// Makes a section of each heading of the footer, such as "Examples:", and notes of what stands before.
std::string footerSections(const std::string& footer) {
  std::string text;
  std::istringstream in(footer);
  bool verbatim = false, noted = false;
  for (std::string line; std::getline(in, line);) {
    if (line.empty()) continue;
    if (line.front() == ' ') {
      if (!verbatim) text += ".nf\n";
      verbatim = true;
      text += roff(line) + "\n";
      continue;
    }
    if (verbatim) text += ".fi\n";
    verbatim = false;
    if (line.back() == ':') {
      text += fmt::format(".SH {}\n", roff(upperCase(line.substr(0, line.size() - 1))));
    } else {
      if (!noted) text += ".SH NOTES\n";
      noted = true;
      text += roff(line) + "\n";
    }
  }
  return text + (verbatim ? ".fi\n" : "");
}

std::string dateOfPage() {
  const char* const given = std::getenv("SOURCE_DATE_EPOCH");
  const std::time_t seconds = given ? std::strtoll(given, nullptr, 10) : std::time(nullptr);
  std::tm date{};
  return ::gmtime_r(&seconds, &date) ? fmt::format("{:%Y-%m-%d}", date) : std::string();
}

}  // namespace

std::string manualPage(const CommandEntry& table, const std::string& version) {
  const std::string name = dashed(table.program);
  std::string help = table.help;  // the line of NAME has no full stop
  if (help.ends_with('.')) help.pop_back();
  std::string text = fmt::format(
      ".\\\" Written by `{} --help-as man`.\n.TH \"{}\" \"1\" \"{}\" \"{}\" \"Lambent\"\n"
      ".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n{}\n",
      table.program, upperCase(roff(name)), dateOfPage(), roff(version), roff(name), roff(help),
      synopsis(table));
  if (!table.commands.empty()) {
    text += ".SH COMMANDS\nEach has a page of its own.\n";
    for (const CommandEntry& command : table.commands)
      text += fmt::format(".TP\n\\fB{}\\fR(1)\n{}\n", roff(dashed(command.program)), roff(command.help));
  }
  text += optionSections(table) + footerSections(table.footer);
  if (const std::size_t space = table.program.find(' '); space != std::string::npos)
    text += fmt::format(".SH SEE ALSO\n\\fB{}\\fR(1)\n", table.program.substr(0, space));
  return text;
}

}  // namespace lambent::command_line
