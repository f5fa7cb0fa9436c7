// Prints what a bake came to, as text or as JSON.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "baker/bake/bake.hpp"

namespace lambent::baker {

struct FinishedBake {
  const std::filesystem::path& output;
  const BakeOptions& options;
  const BakeReport& report;
};

// Returns what the bake measured of its pictures' error, as a sentence's end and as JSON, which is null if
// nothing was measured.
std::string pictureErrorText(const bundle::PictureError& error);
nlohmann::json pictureErrorJson(const std::optional<bundle::PictureError>& error);

// Returns whether a bound on the error, or a limit, was missed.
bool missesBound(const FinishedBake& bake);

// Says in its last line if a bound is missed, and what would help.
void printReport(const FinishedBake& bake);
nlohmann::json reportJson(const FinishedBake& bake);

}  // namespace lambent::baker
