// Rotations of spherical harmonics: block-diagonal, one (2l+1) x (2l+1) block per band, built from a 3x3
// rotation R. Applied to the coefficients of f it gives those of f(R^-1 s), the function carried along by R;
// equally y(R s) = D y(s). So light known in world space goes into an object's frame by
// Rotation(local_from_world). Blocks are computed in double by the recurrence of Ivanic and Ruedenberg (J.
// Phys. Chem. 100, 1996, with the additions of 102, 1998) and applied in float or double. Bad matrices:
// make() refuses them; the constructors assert. Never accumulate a rotation by multiplying matrices or these
// blocks: accumulate a quaternion, renormalise it, and rebuild.
#pragma once

#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/sh/light_vector.hpp"

namespace lambent::sh {

// Proper (determinant +1) and orthonormal to within tolerance in every entry of R^T R.
bool isRotation(const glm::dmat3& matrix, double tolerance = 1e-6);

// The rotation in a matrix that has drifted or carries positive scale: columns are normalised, then passed
// through a unit quaternion. Fails for mirrors, flat or non-finite matrices.
Result<glm::dmat3> orthonormalised(const glm::dmat3& matrix);

class Rotation {
 public:
  Rotation(const glm::dmat3& rotation,
           int order);  // asserts isRotation(rotation) and 1 <= order <= kMaxBasisOrder
  Rotation(const glm::dquat& quaternion, int order);  // any quaternion but zero; normalised here
  static Result<Rotation> make(const glm::dmat3& matrix, int order);

  // Replaces the rotation at the same order without allocating.
  void set(const glm::dmat3& rotation);

  int order() const { return order_; }

  // D_(i,j) with i and j in the same band; 0 elsewhere.
  double entry(int i, int j) const;

  // in and out hold order² coefficients each and must not overlap.
  void apply(std::span<const float> in, std::span<float> out) const;
  void apply(std::span<const double> in, std::span<double> out) const;
  void apply(std::span<const glm::vec3> in, std::span<glm::vec3> out) const;

  // light.order must not exceed order().
  LightVector apply(const LightVector& light) const;

 private:
  int order_ = 0;
  // Column by column, each padded to whole vectors: see bandOffset() in the .cpp.
  std::vector<double> columns_;
  std::vector<float> columns_float_;
};

}  // namespace lambent::sh
