// Implements lambent bake --watch DIR, the pipeline without a window: it bakes every scene of a folder, then
// waits for changes.
#pragma once

#include <filesystem>

#include "baker/bake/options.hpp"
#include "baker/cache/cache.hpp"
#include "baker/import/import_options.hpp"

namespace lambent::baker {

struct WatchArguments {
  std::filesystem::path folder;
  std::filesystem::path output;  // a folder; if empty, bundles lie beside their scenes
  BakeOptions options;
  ImportOptions import;
  bool json = false;   // prints one object per line
  bool quiet = false;  // without `json`, prints errors only, to stderr
};

// Runs until it is interrupted, and returns the exit code: 1 if a scene is broken or its last bake failed.
int watchFolder(const WatchArguments& arguments, Cache* cache);

}  // namespace lambent::baker
