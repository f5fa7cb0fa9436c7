// Rotates spherical harmonics. A rotation R gives a block-diagonal matrix D with one (2l+1) x (2l+1) block
// per band. Applied to the coefficients of f(s), D gives those of f(R^-1 s), the function rotated by R;
// likewise y(R s) = D y(s). Rotation(local_from_world) therefore takes light from world space to an object's
// frame. Blocks are computed in double by the recurrence of Ivanic and Ruedenberg (J. Phys. Chem. 100, 1996,
// with the additions of 102, 1998) and applied in float or double. Do not accumulate a rotation by
// multiplying matrices or blocks, but accumulate a quaternion, normalise it and rebuild.
#pragma once

#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::sh {

// Returns whether the matrix is orthonormal, up to the tolerance in every entry of R^T R, and has a positive
// determinant.
bool isRotation(const glm::dmat3& matrix, double tolerance = 1e-6);

// Returns the rotation of a matrix that has drifted or contains positive scale, by normalising the columns
// and then a quaternion. Fails if the matrix mirrors, is singular or is not finite.
Result<glm::dmat3> orthonormalised(const glm::dmat3& matrix);

class Rotation {
 public:
  // Asserts isRotation(rotation) and 1 <= order <= kMaxBasisOrder.
  Rotation(const glm::dmat3& rotation, int order);
  // Takes a quaternion of any length except zero.
  Rotation(const glm::dquat& quaternion, int order);

  // Replaces the rotation at the same order without allocating.
  void set(const glm::dmat3& rotation);

  int order() const { return order_; }

  // Returns D_(i,j), which is 0 if i and j are in different bands.
  double entry(int i, int j) const;

  // Rotates order² coefficients. `in` and `out` must not overlap.
  void apply(std::span<const float> in, std::span<float> out) const;
  void apply(std::span<const double> in, std::span<double> out) const;
  void apply(std::span<const glm::vec3> in, std::span<glm::vec3> out) const;

  // Rotates a light whose order does not exceed order().
  LightVector apply(const LightVector& light) const;

 private:
  int order_ = 0;
  // Holds the columns of each band, padded to whole SIMD vectors (bandOffset() in rotation.cpp).
  std::vector<double> columns_;
  std::vector<float> columns_float_;
};

}  // namespace lambent::sh
