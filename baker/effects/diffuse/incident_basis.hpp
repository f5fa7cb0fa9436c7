// Represents the light at a normal-mapped point for any normal near the surface's own. It is stored as nine
// values l'_j, bands 0..2 of a function whose convolution with the clamped cosine gives E/pi at the pixel's
// normal n':
//   E(n')/pi = sum_j (A_l/pi) y_j(n') l'_j        (Ramamoorthi and Hanrahan 2001).
// There is no light below the horizon, so plain projection onto nine harmonics would smear it. Instead, the
// nine values of a direction s are those for which the sum is nearest to max(n'·s, 0)/pi over normals n'
// around the surface's (least squares with weight cos²), and exact at the surface's own normal. So a flat
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

  // Returns l'_j of unit radiance per steradian from direction s, in the local frame with z the surface's
  // normal and s.z >= 0.
  std::array<float, kIncident> evaluate(glm::vec3 s) const;

 private:
  // The problem is symmetric about z, so it takes one curve over s.z for each (l, |m|).
  static constexpr std::size_t kSteps = 256;
  std::array<std::array<float, 6>, kSteps + 1> curves_;
};

}  // namespace lambent::baker
