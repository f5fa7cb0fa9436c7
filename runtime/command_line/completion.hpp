// Writes functions with which shells complete the words of a command line.
#pragma once

#include <string>

#include "runtime/command_line/option_table.hpp"

namespace lambent::command_line {

std::string bashCompletion(const CommandEntry& table);
std::string zshCompletion(const CommandEntry& table);
std::string fishCompletion(const CommandEntry& table);

}  // namespace lambent::command_line
