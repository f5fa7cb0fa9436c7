// Decides whether two matrices describe the same placement, up to the rounding of matrices that were
// decomposed and composed again. All callers use this one rule, so that what is shown as moved is also an
// edit of the next bake.
#pragma once

#include <algorithm>
#include <cmath>

#include <glm/mat4x4.hpp>

namespace lambent::editor {

// Translations may differ by 10 um, or by 10^-5 of the largest coordinate if that is beyond 1 m; the other
// entries may differ by 10^-5 of the largest of them.
inline bool samePlace(const glm::mat4& a, const glm::mat4& b) {
  constexpr float kRounding = 1e-5f, kMetre = 1.0f;
  float axes = 0.0f, place = kMetre;
  for (int row = 0; row < 3; ++row) {
    place = std::max(place, std::abs(b[3][row]));
    for (int column = 0; column < 3; ++column) axes = std::max(axes, std::abs(b[column][row]));
  }
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!(std::abs(a[column][row] - b[column][row]) <= kRounding * (column < 3 ? axes : place)))
        return false;
  return true;
}

}  // namespace lambent::editor
