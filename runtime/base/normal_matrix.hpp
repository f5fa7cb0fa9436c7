// Turns normals where a matrix moves points. The inverse transpose does so, but a mesh that its node flattens
// to a plane has no inverse, and one of a very small scale has none in floats. Cofactors are the inverse
// transpose times the determinant and need no division.
#pragma once

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace lambent {

// Returns the inverse transpose times the absolute determinant, which maps area times normal.
inline glm::dmat3 areaMatrix(const glm::dmat3& m) {
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0.0 ? -cofactors : cofactors;
}

// Returns the same, scaled so that the largest entry is 1. It is 0 if the matrix leaves no area.
inline glm::dmat3 normalMatrix(const glm::dmat3& m) {
  const glm::dmat3 areas = areaMatrix(m);
  double largest = 0.0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) largest = std::max(largest, glm::abs(areas[column][row]));
  return largest > 0.0 ? areas / largest : areas;
}
inline glm::mat3 normalMatrix(const glm::mat3& m) {
  return glm::mat3(normalMatrix(glm::dmat3(m)));
}

}  // namespace lambent
