// Implements lambent bake DIR, which bakes every scene of a folder once and ends.
#pragma once

#include "baker/cli/bake_scene.hpp"

namespace lambent::baker {

// `arguments.scene` is the folder, and `arguments.output` a folder for bundles, or empty: beside the scenes.
// Returns the exit code: 1 if a scene has no bundle that shows it as it is.
int bakeFolder(const BakeArguments& arguments, std::optional<Cache>& cache, const std::stop_token& stop);

}  // namespace lambent::baker
