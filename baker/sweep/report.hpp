// Says what a sweep measured and which setting to take. Along each cost, settings lie on the Pareto front if
// no other one has at most its cost and at most its error; the one to take is the knee, where further cost
// stops to pay. All of it goes into sweep.json, and with the pictures into index.html, which draws it
// (page.html).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include "baker/sweep/sweep.hpp"

namespace lambent::baker {

struct CostAndError {
  double cost = 0.0;    // in seconds or bytes; > 0
  double error = 0.0;   // relative; >= 0
  double spread = 0.0;  // how far the error may be off; a smaller difference is none
};

// Returns the indices of the front, in the order of cost. Of equal ones the first counts. Values that are not
// finite never lie on it.
std::vector<std::size_t> paretoFront(std::span<const CostAndError> points);

// Returns the cheapest point of the front from which no later one takes a tenth of the error away for each
// doubling of the cost. A later one whose error may be as large counts for nothing. Nothing for no front.
std::optional<std::size_t> kneeOf(std::span<const CostAndError> points, std::span<const std::size_t> front);

// Returns what sweep.json has (docs/accuracy.md). "costs" come in this order: time of a bake, time of a
// frame, bytes of the bundle, bytes on the GPU.
nlohmann::json sweepJson(const SweepResults& results);

// Writes both files, each whole or not at all, and returns where the page is.
Result<std::filesystem::path> writeReport(const SweepResults& results, const std::filesystem::path& folder);

}  // namespace lambent::baker
