// Builds the local frame of a sample, with z along its normal, without a singularity at the poles (Duff et
// al., JCGT 6(1), 2017).
#pragma once

#include <cmath>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker {

// Returns group_from_local, whose columns are tangent, bitangent and normal. `n` is a unit vector.
inline glm::dmat3 localFrame(const glm::dvec3& n) {
  const double sign = std::copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  const double b = n.x * n.y * a;
  return {glm::dvec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
          glm::dvec3(b, sign + n.y * n.y * a, -n.y), n};
}

}  // namespace lambent::baker
