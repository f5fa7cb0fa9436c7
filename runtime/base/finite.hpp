// Tells whether all numbers of a vector or a matrix are finite.
#pragma once

#include <cmath>

#include <glm/detail/qualifier.hpp>

namespace lambent {

template <glm::length_t N, typename T>
bool isFinite(const glm::vec<N, T>& v) {
  for (glm::length_t i = 0; i < N; ++i)
    if (!std::isfinite(v[i])) return false;
  return true;
}

template <glm::length_t Columns, glm::length_t Rows, typename T>
bool isFinite(const glm::mat<Columns, Rows, T>& matrix) {
  for (glm::length_t column = 0; column < Columns; ++column)
    if (!isFinite(matrix[column])) return false;
  return true;
}

}  // namespace lambent
