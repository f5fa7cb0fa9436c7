// Normal maps want the light at a point for any normal near the surface's own. It is stored as nine numbers
// l'_j, bands 0..2 of a function whose convolution with the clamped cosine gives E/pi at the pixel's normal
// n':
//   E(n')/pi = sum_j (A_l/pi) y_j(n') l'_j        (Ramamoorthi and Hanrahan 2001).
// Light below the horizon is known to be nothing, so plain projection onto nine harmonics would smear it; the
// nine numbers of a direction s are instead those for which the sum is nearest to max(n'·s, 0)/pi over
// normals n' about the surface's (least squares, weight cos²), and exact at the surface's own normal: a flat
// normal map changes nothing.
#pragma once

#include <array>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::baker {

inline constexpr std::size_t kIncident = 9;

class IncidentBasis {
 public:
  IncidentBasis();

  // l'_j of unit radiance from the direction s per steradian; local frame, z the surface's normal, s.z >= 0.
  std::array<float, kIncident> evaluate(glm::vec3 s) const;

 private:
  // The problem is symmetric about z: one curve over s.z for each (l, |m|).
  static constexpr std::size_t kSteps = 256;
  std::array<std::array<float, 6>, kSteps + 1> curves_;
};

}  // namespace lambent::baker
