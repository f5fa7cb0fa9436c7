// Makes random numbers and directions, the same in each run.
#pragma once

#include <cstdint>
#include <random>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lambent::testing {

template <typename T>
struct Random {
  std::mt19937 engine;

  explicit Random(std::uint32_t seed) : engine(seed) {}
  T number(T low, T high) { return std::uniform_real_distribution<T>(low, high)(engine); }
  glm::vec<3, T> direction() {
    for (;;) {
      const glm::vec<3, T> v(number(-1, 1), number(-1, 1), number(-1, 1));
      if (const T squared = glm::dot(v, v); squared > T(0.01) && squared < T(1)) return glm::normalize(v);
    }
  }
};

}  // namespace lambent::testing
