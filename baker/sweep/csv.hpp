// Writes what a sweep measured as tables for other programs. Errors are shares, times seconds or
// milliseconds, as the heads of the columns say. Pure.
#pragma once

#include <string>

#include "baker/sweep/sweep.hpp"

namespace lambent::baker {

// A line for each setting.
std::string settingsCsv(const SweepResults& results);
// A line for each stage of a bake and each pass of a frame.
std::string timesCsv(const SweepResults& results);

}  // namespace lambent::baker
