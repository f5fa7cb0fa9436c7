// Interpolates a measured BRDF between its measurements for the reference (docs/conventions.md, "Materials"):
// by a weighted mean over the angles of half vector and difference, tabulated once, and scaled down where it
// would reflect more than it receives.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "baker/import/measured_brdf.hpp"
#include "reference/whole_brdf.hpp"

namespace lambent::baker::reference {

class MeasuredReflection final : public WholeBrdf {
 public:
  explicit MeasuredReflection(const MeasuredBrdf& measured);

  glm::vec3 value(const glm::vec3& v, const glm::vec3& s) const override;
  float alpha() const override { return alpha_; }

 private:
  glm::vec3 unscaled(const glm::vec3& v, const glm::vec3& s) const;
  float scale(float cosine) const;

  std::vector<glm::vec3> values_;  // [theta_d][sqrt of theta_h]
  std::vector<float> scales_;      // by the root of the cosine
  float alpha_ = 0.2f;
};

}  // namespace lambent::baker::reference
