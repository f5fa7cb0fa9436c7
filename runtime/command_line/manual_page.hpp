// Writes a manual page for man(1).
#pragma once

#include <string>

#include "runtime/command_line/option_table.hpp"

namespace lambent::command_line {

// `version` is what --version prints, as "lambent 1.2". The page bears the date of SOURCE_DATE_EPOCH, which
// reproducible builds set (reproducible-builds.org/specs/source-date-epoch), or else of today.
std::string manualPage(const CommandEntry& table, const std::string& version);

}  // namespace lambent::command_line
