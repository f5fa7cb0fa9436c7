// Makes transfer vectors that form clusters, to test their coding.
#pragma once

#include <array>
#include <cstddef>
#include <random>
#include <vector>

namespace lambent::testing {

// Makes `heaps` clusters of adjacent samples, each around its own mean and along three directions that all
// share. The layout is [sample][size].
inline std::vector<float> heaps(std::size_t samples, std::size_t heaps, std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> parts(size * (heaps + 3)), vectors;
  for (float& value : parts) value = normal(random);
  for (std::size_t s = 0; s < samples; ++s) {
    const std::array<float, 3> along = {normal(random), normal(random), normal(random)};
    for (std::size_t i = 0; i < size; ++i) {
      float value = 2.0f * parts[size * (s * heaps / samples) + i];
      for (std::size_t k = 0; k < 3; ++k) value += along[k] * parts[size * (heaps + k) + i];
      vectors.push_back(value);
    }
  }
  return vectors;
}

}  // namespace lambent::testing
