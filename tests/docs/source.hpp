// Where the sources of the project are.
#pragma once

#include <filesystem>

namespace lambent {

inline const std::filesystem::path kSource = LAMBENT_SOURCE_DIR;

}  // namespace lambent
