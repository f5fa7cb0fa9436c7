// Tells the version of the library. Programs that were linked against one run with every later one of the
// same LAMBENT_ABI, which is the number in the libraries' names (docs/library.md).
#pragma once

#include "lambent/export.hpp"

#define LAMBENT_ABI 0

namespace lambent {

// Returns the version that runs, like "0.10.0".
LAMBENT_API const char* version();

}  // namespace lambent
