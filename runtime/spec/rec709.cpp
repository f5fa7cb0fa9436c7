#include "runtime/spec/rec709.hpp"

#include <cmath>

#include <glm/matrix.hpp>

namespace lambent::spec {

namespace {

// Responses of cones to CIE XYZ, as Lam fitted them for the Bradford transform.
const glm::dmat3 kConesFromXyz =
    glm::transpose(glm::dmat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));

glm::dvec3 xyzOf(const glm::dvec2& xy) {
  return {xy.x, xy.y, 1.0 - xy.x - xy.y};
}

// XYZ of white with luminance 1.
glm::dvec3 whiteOf(const Primaries& primaries) {
  return xyzOf(primaries.white) / primaries.white.y;
}

// Columns are the primaries, each as strong as white needs it (SMPTE RP 177).
glm::dmat3 xyzFromRgb(const Primaries& primaries) {
  const glm::dmat3 columns(xyzOf(primaries.red), xyzOf(primaries.green), xyzOf(primaries.blue));
  const glm::dvec3 strength = glm::inverse(columns) * whiteOf(primaries);
  return {columns[0] * strength.x, columns[1] * strength.y, columns[2] * strength.z};
}

}  // namespace

std::optional<glm::mat3> rec709From(const Primaries& primaries) {
  constexpr double kMostRounding = 1e-3;
  constexpr double kMostGain = 100.0;  // real spaces need less than 3
  const glm::dvec3 from = kConesFromXyz * whiteOf(primaries), to = kConesFromXyz * whiteOf(Primaries{});
  // Each cone adapts to white by itself (von Kries).
  const glm::dmat3 adapted(to.x / from.x, 0.0, 0.0, 0.0, to.y / from.y, 0.0, 0.0, 0.0, to.z / from.z);
  const glm::dmat3 matrix = glm::inverse(xyzFromRgb(Primaries{})) * glm::inverse(kConesFromXyz) * adapted *
                            kConesFromXyz * xyzFromRgb(primaries);
  bool rounding = true;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) {
      if (!(std::abs(matrix[column][row]) <= kMostGain)) return std::nullopt;
      rounding = rounding && std::abs(matrix[column][row] - (row == column ? 1.0 : 0.0)) <= kMostRounding;
    }
  return rounding ? glm::mat3(1.0f) : glm::mat3(matrix);
}

glm::mat3 rec709FromXyz() {
  return glm::mat3(glm::inverse(xyzFromRgb(Primaries{})));
}

}  // namespace lambent::spec
