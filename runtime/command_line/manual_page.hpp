// Writes a manual page for man(1).
#pragma once

#include <string>

#include "runtime/command_line/option_table.hpp"

namespace lambent::command_line {

// `version` is what --version prints, as "lambent 1.2".
std::string manualPage(const CommandEntry& table, const std::string& version);

}  // namespace lambent::command_line
