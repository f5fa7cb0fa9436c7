// lambent bake --watch DIR: the pipeline without a window. Bakes every scene of a folder, then waits for
// changes.
#pragma once

#include <filesystem>

#include "baker/bake/options.hpp"
#include "baker/cache/cache.hpp"
#include "baker/import/import_options.hpp"

namespace lambent::baker {

struct WatchArguments {
  std::filesystem::path folder;
  std::filesystem::path output;  // a folder; empty: bundles lie beside their scenes
  BakeOptions options;
  ImportOptions import;
  bool json = false;  // an object per line
};

// Until it is interrupted. The exit code.
int watchFolder(const WatchArguments& arguments, Cache* cache);

}  // namespace lambent::baker
