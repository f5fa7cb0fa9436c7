// Writes the results of a sweep into its folder: index.html, settings.csv, times.csv, and an SVG for each
// cost. Each file appears whole or not at all.
#pragma once

#include <filesystem>
#include <vector>

#include "baker/sweep/sweep.hpp"

namespace lambent::baker {

// Returns the files that were written.
Result<std::vector<std::filesystem::path>> writeResults(const SweepResults& results,
                                                        const std::filesystem::path& folder);

}  // namespace lambent::baker
