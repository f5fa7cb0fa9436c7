#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "runtime/command_line/help.hpp"

namespace lambent::command_line {

namespace {

// Functions of shells have no hyphens in their names.
std::string functionName(std::string program) {
  std::ranges::replace(program, '-', '_');
  std::ranges::replace(program, ' ', '_');
  return "_" + program;
}

std::string namesOf(const CommandEntry& table) {
  std::string names;
  for (const OptionEntry& option : table.options)
    for (const std::string& name : option.names) names += (names.empty() ? "" : " ") + name;
  return names;
}

std::vector<std::string> commandNames(const CommandEntry& table) {
  std::vector<std::string> names;
  for (const CommandEntry& command : table.commands) names.push_back(command.name);
  return names;
}

// Returns what fits beside a word: the first clause of the help.
std::string shortHelp(const std::string& help) {
  return help.substr(0, std::min(help.find(". "), help.find("; ")));
}

std::string escaped(const std::string& text, const char* letters) {
  std::string out;
  for (const char c : text) {
    if (std::string_view(letters).find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string quoted(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return "'" + out + "'";
}

// Writes the cases of options that take a value, which `command` has before it.
std::string bashValues(const CommandEntry& table, const std::string& command) {
  std::string cases;
  for (const OptionEntry& option : table.options) {
    if (option.names.empty() || !option.takesValue()) continue;
    std::string pattern;
    for (const std::string& name : option.names)
      pattern += fmt::format("{}\"{} {}\"", pattern.empty() ? "" : "|", command, name);
    const auto words = option.words();
    // Values that are no words may be files or folders.
    cases += fmt::format("    {}) COMPREPLY=($(compgen {} -- \"$cur\")); return ;;\n", pattern,
                         words.empty() ? std::string("-f") : fmt::format("-W \"{}\"", fmt::join(words, " ")));
  }
  return cases;
}

std::string zshOptions(const CommandEntry& table, const char* indent) {
  std::string specs;
  for (const OptionEntry& option : table.options) {
    const std::string help = escaped(shortHelp(option.help), "[]:\\");
    std::string value;
    if (option.takesValue()) {
      const auto words = option.words();
      value = words.empty() ? ":value:_files" : fmt::format(":value:({})", fmt::join(words, " "));
    }
    for (const std::string& name : option.names)
      specs += fmt::format(" \\\n{}{}", indent, quoted(fmt::format("*{}[{}]{}", name, help, value)));
  }
  return specs;
}

std::string fishOptions(const CommandEntry& table, const std::string& program, const std::string& where) {
  std::string lines;
  for (const OptionEntry& option : table.options) {
    if (option.names.empty()) continue;
    std::string line = fmt::format("complete -c {}{}", program, where);
    for (const std::string& name : option.names)
      line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    const auto words = option.words();
    if (!words.empty())
      line += fmt::format(" -x -a '{}'", fmt::join(words, " "));
    else if (option.takesValue())
      line += " -r";
    std::string help = quoted(shortHelp(option.help));
    lines += line + " -d " + help + "\n";
  }
  return lines;
}

}  // namespace

std::string bashCompletion(const CommandEntry& table) {
  const auto commands = commandNames(table);
  std::string values = bashValues(table, ""),
              options = fmt::format("    *) options=\"{}\" ;;\n", namesOf(table));
  std::string cases;
  for (const CommandEntry& command : table.commands) {
    values += bashValues(command, command.name);
    cases += fmt::format("    {}) options=\"{}\" ;;\n", command.name, namesOf(command));
  }
  const std::string find_command = commands.empty()
                                       ? ""
                                       : fmt::format(
                                             "  for word in \"${{COMP_WORDS[@]:1:COMP_CWORD-1}}\"; do\n"
                                             "    case $word in {}) command=$word; break ;; esac\n  done\n",
                                             fmt::join(commands, "|"));
  const std::string offer_commands =
      commands.empty()
          ? ""
          : fmt::format("  elif [[ -z $command ]]; then\n    COMPREPLY=($(compgen -W \"{}\" -- \"$cur\"))\n",
                        fmt::join(commands, " "));
  const std::string function = functionName(table.program);
  return fmt::format(
      "# Completion in bash, written by `{0} --help-as bash`.\n"
      "{1}() {{\n"
      "  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} command= options= word=\n"
      "{2}"
      "  case \"$command $prev\" in\n{3}  esac\n"
      "  case $command in\n{4}{5}  esac\n"
      "  if [[ $cur == -* ]]; then\n    COMPREPLY=($(compgen -W \"$options\" -- \"$cur\"))\n"
      "{6}"
      "  else\n    COMPREPLY=($(compgen -f -- \"$cur\"))\n  fi\n"
      "}}\n"
      "complete -o filenames -F {1} {0}",
      table.program, function, find_command, values, cases, options, offer_commands);
}

std::string zshCompletion(const CommandEntry& table) {
  const std::string function = functionName(table.program);
  std::string text =
      fmt::format("#compdef {0}\n# Completion in zsh, written by `{0} --help-as zsh`.\n{1}() {{\n",
                  table.program, function);
  if (table.commands.empty()) {
    text += fmt::format("  _arguments{} \\\n    '*:file:_files'\n", zshOptions(table, "    "));
  } else {
    std::string described, cases;
    for (const CommandEntry& command : table.commands) {
      described += fmt::format(" {}", quoted(command.name + ":" + escaped(shortHelp(command.help), ":\\")));
      cases += fmt::format("      {}) _arguments{} \\\n        '*:file:_files' ;;\n", command.name,
                           zshOptions(command, "        "));
    }
    text += fmt::format(
        "  local -a commands=({})\n  local line state\n"
        "  _arguments -C{} \\\n    '1:command:->command' '*::argument:->arguments'\n"
        "  case $state in\n    command) _describe command commands ;;\n"
        "    arguments) case $line[1] in\n{}    esac ;;\n  esac\n",
        described, zshOptions(table, "    "), cases);
  }
  return text + fmt::format("}}\n{} \"$@\"", function);
}

std::string fishCompletion(const CommandEntry& table) {
  std::string text = fmt::format("# Completion in fish, written by `{} --help-as fish`.\n", table.program);
  if (table.commands.empty()) return text + fishOptions(table, table.program, "");
  text += fishOptions(table, table.program, " -n __fish_use_subcommand");
  for (const CommandEntry& command : table.commands) {
    text += fmt::format("complete -c {} -n __fish_use_subcommand -f -a {} -d {}\n", table.program,
                        command.name, quoted(shortHelp(command.help)));
    text += fishOptions(command, table.program,
                        fmt::format(" -n '__fish_seen_subcommand_from {}'", command.name));
  }
  return text;
}

}  // namespace lambent::command_line
