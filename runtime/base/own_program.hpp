// Finds the file of the running program, and what was installed or built along with it.
#pragma once

#include <filesystem>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent {

// Fails where the system does not say which file runs.
Result<std::filesystem::path> ownProgram();

// Returns the folders of sample scenes and environment maps that came with a program: beside an installed one
// in share/lambent, in a build folder in assets. There may be none.
std::vector<std::filesystem::path> sampleFolders(
    const std::filesystem::path& program = ownProgram().value_or(std::filesystem::path()));

}  // namespace lambent
