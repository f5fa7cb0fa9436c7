#include "runtime/lighting/fewer_samples.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include <glm/geometric.hpp>

namespace lambent::lighting {

FewerSamples fewerSamples(std::span<const glm::vec3> samples, std::uint32_t most) {
  FewerSamples result;
  const std::size_t count = std::min<std::size_t>(samples.size(), std::max(most, 1u));
  if (count == samples.size()) {
    result.kept.resize(count);
    std::iota(result.kept.begin(), result.kept.end(), 0u);
    result.place = result.kept;
    return result;
  }
  // The first is the one nearest to their middle.
  glm::vec3 middle(0.0f);
  for (const glm::vec3& sample : samples) middle += sample / static_cast<float>(samples.size());
  const auto farther = [&](const glm::vec3& a, const glm::vec3& b) {
    return glm::distance(a, middle) < glm::distance(b, middle);
  };
  auto next = static_cast<std::size_t>(std::ranges::min_element(samples, farther) - samples.begin());
  std::vector<float> distance(samples.size(), std::numeric_limits<float>::infinity());
  while (result.kept.size() < count) {
    result.kept.push_back(static_cast<std::uint32_t>(next));
    for (std::size_t i = 0; i < samples.size(); ++i)
      distance[i] = std::min(distance[i], glm::distance(samples[i], samples[next]));
    next = static_cast<std::size_t>(std::ranges::max_element(distance) - distance.begin());
  }
  std::ranges::sort(result.kept);
  // Places may coincide.
  result.kept.erase(std::unique(result.kept.begin(), result.kept.end()), result.kept.end());
  for (const glm::vec3& sample : samples) {
    const auto nearest = std::ranges::min_element(
        result.kept, {}, [&](std::uint32_t k) { return glm::distance(sample, samples[k]); });
    result.place.push_back(static_cast<std::uint32_t>(nearest - result.kept.begin()));
  }
  return result;
}

}  // namespace lambent::lighting
