// Turning a function to any frame without a rotation matrix: it is written as a sum of zonal functions about
// a few fixed axes of its own frame (Nowrouzezahrai, Simari and Fiume 2012, sparse zonal factorisation),
//   f(s) = Σ_l Σ_i w_l,i Σ_m y_lm(a_i) y_lm(s),
// so in another frame only the axes turn: f_lm = Σ_i w_l,i y_lm(R a_i). Band l takes the first axesOfBand(l)
// axes. The first axis is z, the normal.
//   isotropic:   functions that mirror in the xz plane (m >= 0 only). Axes in that plane; l + 1 of them for
//   band l. anisotropic: any function; 2l + 1 axes for band l.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::sh {

inline constexpr int kMaxFactoredOrder = 9;

class ZonalFactors {
 public:
  // order 1..kMaxFactoredOrder.
  static ZonalFactors isotropic(int order);
  static ZonalFactors anisotropic(int order);

  int order() const { return order_; }
  bool isIsotropic() const { return isotropic_; }
  // Unit, in the function's own frame: `order` of them (isotropic), else 2 order - 1.
  std::span<const glm::vec3> axes() const { return axes_; }
  int axesOfBand(int l) const { return isotropic_ ? l + 1 : 2 * l + 1; }
  // order (order + 1) / 2, or order²: as many as the function has coefficients.
  int weightCount() const;

  // coefficients: as BrdfTable stores them (isotropic: m >= 0, (l, m) at l(l+1)/2 + m). weights: band by
  // band, axis by axis: w_l,i at l(l+1)/2 + i, or l² + i.
  void factor(std::span<const float> coefficients, std::span<float> weights) const;
  // The order² coefficients of the function in a frame with these axes (the turned axes(), as many).
  void expand(std::span<const float> weights, std::span<const glm::vec3> turned_axes,
              std::span<float> out) const;

 private:
  ZonalFactors(int order, bool isotropic);
  int order_;
  bool isotropic_;
  std::vector<glm::vec3> axes_;
  std::vector<double> inverses_;  // of each band, one after the other, row-major
};

}  // namespace lambent::sh
