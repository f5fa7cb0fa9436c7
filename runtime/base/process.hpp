// What a program does by way of the system that runs it: it runs other programs, finds its own file, tells
// how much memory it takes, and checks that what it printed has arrived.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent {

// Runs another program to its end and returns what it printed and how long processors worked for it. Its
// words come in without a shell between, so any file name is safe. A stop request ends the program. Errors
// carry the last line that the program wrote to stderr.
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

// Finds the file of the running program, and what was installed or built along with it.

// Fails where the system does not say which file runs.
Result<std::filesystem::path> ownProgram();

// Returns the folders of sample scenes and environment maps that came with a program: beside an installed one
// in share/lambent, in a build folder in assets. There may be none.
std::vector<std::filesystem::path> sampleFolders(
    const std::filesystem::path& program = ownProgram().value_or(std::filesystem::path()));

// Says how much memory this program takes, in bytes; 0 where the system does not tell.
std::uint64_t addressSpaceBytes();  // what is reserved now
std::uint64_t residentBytes();      // what is in physical memory now
std::uint64_t peakBytes();          // the most that has been in physical memory so far
void returnFreedMemory();      // gives memory that the program has freed back to the system, where it can
std::uint64_t machineBytes();  // the physical memory of the machine, whoever uses it

// Checks that what a program printed has arrived.

// Flushes standard output. Fails if any of it could not be written, because a full disk or a closed file
// shows only now.
Result<void> flushStandardOutput();

}  // namespace lambent
