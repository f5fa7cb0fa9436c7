// Finds the sample scenes that came with the program: beside an installed one in share/lambent/scenes, in a
// build folder in assets.
#pragma once

#include <filesystem>
#include <vector>

namespace lambent::editor {

// Returns the scenes in these places of the folder above that of the program, by name. Without arguments the
// running program is meant.
std::vector<std::filesystem::path> sampleScenes(const std::filesystem::path& program = "/proc/self/exe");

}  // namespace lambent::editor
