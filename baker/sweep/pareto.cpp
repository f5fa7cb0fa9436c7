#include "baker/sweep/pareto.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lambent::baker {

std::vector<std::size_t> paretoFront(std::span<const CostAndError> points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::isfinite(points[i].cost) && std::isfinite(points[i].error)) order.push_back(i);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return points[a].cost != points[b].cost ? points[a].cost < points[b].cost
                                            : points[a].error < points[b].error;
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (!(points[i].error < least)) continue;
    least = points[i].error;
    front.push_back(i);
  }
  return front;
}

double gainPerDoubling(const CostAndError& from, const CostAndError& to) {
  if (!(from.error > 0.0) || !(from.cost > 0.0) || !(to.cost > from.cost)) return 0.0;
  return 1.0 - std::pow(to.error / from.error, 1.0 / std::log2(to.cost / from.cost));
}

std::optional<std::size_t> kneeOf(std::span<const CostAndError> points, std::span<const std::size_t> front) {
  for (std::size_t i = 0; i < front.size(); ++i) {
    const bool worth =
        std::any_of(front.begin() + static_cast<std::ptrdiff_t>(i) + 1, front.end(), [&](std::size_t later) {
          const CostAndError &from = points[front[i]], &to = points[later];
          const bool certain = from.error - to.error > std::max(from.spread, to.spread);
          return certain && gainPerDoubling(from, to) >= kLeastGain;
        });
    if (!worth) return front[i];
  }
  return std::nullopt;
}

}  // namespace lambent::baker
