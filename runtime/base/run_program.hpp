// Runs another program to its end and returns what it printed and how long processors worked for it. Its
// words come in without a shell between, so any file name is safe. A stop request ends the program. Errors
// carry the last line that the program wrote to stderr.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent {

struct Ran {
  std::string out, err;  // standard output and errors
  int exit_code = 0;
  double processor_seconds = 0.0;  // of all its threads together
};

// Fails if it cannot be started, is ended by a signal, or is stopped.
Result<Ran> runToAnyEnd(const std::filesystem::path& program, const std::vector<std::string>& words,
                        const std::stop_token& stop);
// Fails also if it ends with another code than 0.
Result<Ran> runProgram(const std::filesystem::path& program, const std::vector<std::string>& words,
                       const std::stop_token& stop);

}  // namespace lambent
