// Says in one sentence what is wrong with a command line, for all programs.
#pragma once

#include "runtime/base/result.hpp"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace lambent::command_line {

// Returns what to print for an error that `app` threw while it parsed. A word that is not known is named with
// the nearest one that is.
Error usageError(const CLI::App& app, const CLI::ParseError& wrong);

}  // namespace lambent::command_line
