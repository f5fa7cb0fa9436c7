#include "baker/importance/regions.hpp"

#include <algorithm>
#include <utility>

#include <glm/common.hpp>

namespace lambent::baker {

Regions::Regions(std::vector<glm::vec3> points, int depth) {
  if (points.empty()) return;
  depth_ = depth;
  cuts_.resize(size() - 1);
  std::vector<std::span<glm::vec3>> parts(cuts_.size() + size());
  parts[0] = points;
  for (std::size_t i = 0; i < cuts_.size(); ++i) {
    const std::span<glm::vec3> part = parts[i];
    if (part.empty()) continue;
    glm::vec3 low = part[0], high = low;
    for (const glm::vec3& p : part) low = glm::min(low, p), high = glm::max(high, p);
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
    std::nth_element(part.begin(), middle, part.end(),
                     [axis](const glm::vec3& a, const glm::vec3& b) { return a[axis] < b[axis]; });
    cuts_[i] = {axis, (*middle)[axis]};
    const auto left = static_cast<std::size_t>(middle - part.begin());
    parts[2 * i + 1] = part.first(left);
    parts[2 * i + 2] = part.subspan(left);
  }
}

std::size_t Regions::at(const glm::vec3& position) const {
  std::size_t i = 0;
  while (i < cuts_.size()) i = 2 * i + (position[cuts_[i].axis] < cuts_[i].at ? 1 : 2);
  return i - cuts_.size();
}

double boundingError(std::span<const double> errors, std::span<const double> weights) {
  constexpr double kShare = 0.95;
  std::vector<std::pair<double, double>> sorted;
  double all = 0.0;
  for (std::size_t r = 0; r < errors.size(); ++r)
    if (weights[r] > 0.0) sorted.emplace_back(errors[r], weights[r]), all += weights[r];
  std::ranges::sort(sorted);
  double sum = 0.0;
  for (const auto& [error, weight] : sorted)
    if ((sum += weight) >= kShare * all) return error;
  return 0.0;
}

}  // namespace lambent::baker
