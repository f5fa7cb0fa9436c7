// A measured BRDF as the reference reads it between its measurements (docs/conventions.md, "Materials"): the
// weighed mean over the angles of half vector and difference, tabulated once, and scaled down where it would
// reflect more than it receives.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "baker/import/measured_brdf.hpp"

namespace lambent::baker::reference {

class MeasuredReflection {
 public:
  static MeasuredReflection build(const MeasuredBrdf& measured);

  // f, local; v and s above the surface.
  glm::vec3 value(const glm::vec3& v, const glm::vec3& s) const;
  // The GGX lobe about as wide as the highlight, to draw directions by.
  float alpha() const { return alpha_; }

 private:
  glm::vec3 unscaled(const glm::vec3& v, const glm::vec3& s) const;
  float scale(float cosine) const;

  std::vector<glm::vec3> values_;  // [theta_d][sqrt of theta_h]
  std::vector<float> scales_;      // by the root of the cosine
  float alpha_ = 0.2f;
};

}  // namespace lambent::baker::reference
