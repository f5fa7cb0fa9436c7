// Rotates a function without a rotation matrix. The function is written as a sum of zonal functions about a
// few fixed axes of its own frame (Nowrouzezahrai, Simari and Fiume 2012, sparse zonal factorisation):
//   f(s) = Σ_l Σ_i w_l,i Σ_m y_lm(a_i) y_lm(s).
// In another frame only the axes change: f_lm = Σ_i w_l,i y_lm(R a_i). Band l uses the first axesOfBand(l)
// axes. The first axis is z, the normal.
// Isotropic factors are for functions that are symmetric about the xz plane (only m >= 0): their axes lie in
// that plane, and band l uses l + 1 of them. Anisotropic factors are for any function: band l uses 2l + 1
// axes.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::sh {

inline constexpr int kMaxFactoredOrder = 9;

class ZonalFactors {
 public:
  // `order` is in 1..kMaxFactoredOrder.
  static ZonalFactors isotropic(int order);
  static ZonalFactors anisotropic(int order);

  int order() const { return order_; }
  bool isIsotropic() const { return isotropic_; }
  // Returns unit axes in the function's own frame: `order` of them if isotropic, else 2 order - 1.
  std::span<const glm::vec3> axes() const { return axes_; }
  int axesOfBand(int l) const { return isotropic_ ? l + 1 : 2 * l + 1; }
  // Returns the number of weights, which is that of the function's coefficients: order (order + 1) / 2 if
  // isotropic, else order².
  int weightCount() const;

  // Computes the weights of a function. Coefficients are ordered as in BrdfTable (if isotropic, only m >= 0,
  // with (l, m) at l(l+1)/2 + m). Weight w_l,i goes to l(l+1)/2 + i if isotropic, else to l² + i.
  void factor(std::span<const float> coefficients, std::span<float> weights) const;
  // Writes the order² coefficients of the function in the frame in which axes() are `turned_axes`.
  void expand(std::span<const float> weights, std::span<const glm::vec3> turned_axes,
              std::span<float> out) const;

 private:
  ZonalFactors(int order, bool isotropic);
  int order_;
  bool isotropic_;
  std::vector<glm::vec3> axes_;
  std::vector<double> inverses_;  // inverse matrices y_lm(a_i) of all bands, row-major
};

}  // namespace lambent::sh
