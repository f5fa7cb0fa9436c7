// Finds which settings are worth their cost. A setting lies on the Pareto front if no other one has at most
// its cost and at most its error. The knee is where further cost stops to pay. All functions are pure.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace lambent::baker {

struct CostAndError {
  double cost = 0.0;    // in seconds or bytes; > 0
  double error = 0.0;   // relative; >= 0
  double spread = 0.0;  // how far the error may be off; a smaller difference is none
};

// Returns the indices of the front, in the order of cost. Of equal ones the first counts. Values that are not
// finite never lie on it.
std::vector<std::size_t> paretoFront(std::span<const CostAndError> points);

// A step along the front is worth it while each doubling of the cost takes at least this share of the error
// away.
inline constexpr double kLeastGain = 0.1;

// Returns the share of the error of `from` that each doubling of the cost takes away on the way to `to`,
// which costs more and errs less.
double gainPerDoubling(const CostAndError& from, const CostAndError& to);

// Returns the cheapest point of the front from which no later one is worth its cost. A later one whose error
// may be as large counts for nothing. Nothing for no front.
std::optional<std::size_t> kneeOf(std::span<const CostAndError> points, std::span<const std::size_t> front);

}  // namespace lambent::baker
