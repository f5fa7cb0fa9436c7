// Names the folder with the sources of the project.
#pragma once

#include <filesystem>

namespace lambent {

inline const std::filesystem::path kSource = LAMBENT_SOURCE_DIR;

}  // namespace lambent
