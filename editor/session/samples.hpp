// Finds the sample scenes and environment maps that came with the program: beside an installed one in
// share/lambent, in a build folder in assets.
#pragma once

#include <filesystem>
#include <vector>

namespace lambent::editor {

// Returns those of these places that exist in the folder above that of the program. Without arguments the
// running program is meant.
std::vector<std::filesystem::path> sampleFolders(const std::filesystem::path& program = "/proc/self/exe");

}  // namespace lambent::editor
