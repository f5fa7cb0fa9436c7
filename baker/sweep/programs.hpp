// Finds the programs that a sweep runs. The baker cannot link the runtime's frame, so pictures are drawn by
// lambent-demo, which lies beside lambent in a build and in a package.
#pragma once

#include <filesystem>

#include "runtime/base/result.hpp"

namespace lambent::baker {

struct Programs {
  std::filesystem::path lambent, demo;
};

// Finds this program and lambent-demo beside it. Fails if there is none.
Result<Programs> findPrograms();

// Returns the sample scene that a sweep measures if none is named. Fails if it is not where a build or a
// package has it.
Result<std::filesystem::path> findSampleScene();

}  // namespace lambent::baker
