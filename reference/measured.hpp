// Interpolates a measured BRDF for the reference (docs/conventions.md, "Materials") by a weighted mean over
// the half-vector and difference angles, tabulated once. It is scaled down where it would reflect more energy
// than it receives.
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
  std::vector<float> scales_;      // by the square root of the cosine
  float alpha_ = 0.2f;
};

}  // namespace lambent::baker::reference
