// Runs another program to its end and returns what it printed. Its words come in without a shell between, so
// any file name is safe. A stop request ends the program. Errors carry the last line that the program wrote
// to stderr.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::baker {

// Returns the standard output of the program. Fails if it cannot be started, ends with another code than 0,
// or is stopped.
Result<std::string> runProgram(const std::filesystem::path& program, const std::vector<std::string>& words,
                               const std::stop_token& stop);

}  // namespace lambent::baker
