// Prints what a bake came to, as text or as JSON.
#pragma once

#include <filesystem>

#include "baker/bake/bake.hpp"

namespace lambent::baker {

struct FinishedBake {
  const std::filesystem::path& output;
  const BakeOptions& options;
  const BakeReport& report;
};

// Returns whether codes with this error miss the bound.
bool missesBound(double error, double bound);

// Says in its last line if a bound on the error is missed.
void printReport(const FinishedBake& bake);
void printReportJson(const FinishedBake& bake);

}  // namespace lambent::baker
