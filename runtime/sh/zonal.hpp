// Computes with zonal functions, which are symmetric about an axis: the clamped cosine, unoccluded diffuse
// transfer, disc lights, zonal rotation and convolution. A zonal function is given by its n coefficients z_l
// about its own axis: f = sum_l z_l y_l0. Angles are in radians, directions are unit vectors towards the
// light, radiance is linear RGB. Sources: Ramamoorthi and Hanrahan 2001 (A_l); Sloan 2008, "Stupid Spherical
// Harmonics Tricks" (zonal rotation, convolution).
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/sh/basis.hpp"

namespace lambent::sh {

// Returns A_l, by which convolution with max(cos, 0) scales band l: pi, 2pi/3, pi/4, 0, -pi/24, 0, pi/64, ...
double clampedCosine(int l);

// Returns the Legendre polynomial P_l(t).
double legendre(int l, double t);

// Writes t_i = (A_l/pi) y_i(normal), the diffuse transfer of an unoccluded point without the receiver's
// albedo, to the order² entries of `out`.
void unoccludedTransfer(int order, const glm::vec3& normal, std::span<float> out);
void unoccludedTransfer(int order, const glm::dvec3& normal, std::span<double> out);

// Returns z_l of a disc (or distant sphere) of radiance 1 about its axis. The angular radius is clamped to
// 0..pi.
double discZonal(int l, double angular_radius_rad);

// Returns a uniform disc of light about dir, such as the sun or a distant spherical lamp. With a radius of pi
// it is constantLight.
LightVector discLight(int order, const glm::vec3& dir, double angular_radius_rad,
                      const glm::vec3& radiance_rgb);

// Returns light with the same radiance from all directions.
LightVector constantLight(int order, const glm::vec3& radiance_rgb);

// Writes the coefficients of the zonal function zonal[0..order-1], with its axis rotated to dir, to the
// order² entries of `out`.
void rotateZonal(int order, std::span<const double> zonal, const glm::dvec3& dir, std::span<double> out);

// Returns irradiance / pi as a function of the normal, which is light with band l scaled by A_l/pi. Uniform
// light stays unchanged.
LightVector cosineConvolved(const LightVector& light);

// Rotates a function without a rotation matrix. The function is written as a sum of zonal functions about a
// few fixed axes of its own frame (Nowrouzezahrai, Simari and Fiume 2012, sparse zonal factorisation):
//   f(s) = Σ_l Σ_i w_l,i Σ_m y_lm(a_i) y_lm(s).
// In another frame only the axes change: f_lm = Σ_i w_l,i y_lm(R a_i). Band l uses the first axesOfBand(l)
// axes. The first axis is z, the normal.
// Isotropic factors are for functions that are symmetric about the xz plane (only m >= 0): their axes lie in
// that plane, and band l uses l + 1 of them. Anisotropic factors are for any function: band l uses 2l + 1
// axes.
inline constexpr int kMaxFactoredOrder = 9;

class ZonalFactors {
 public:
  // `order` is in 1..kMaxFactoredOrder.
  ZonalFactors(int order, bool isotropic);

  int order() const { return order_; }
  // Returns unit axes in the function's own frame: `order` of them if isotropic, else 2 order - 1.
  std::span<const glm::vec3> axes() const { return axes_; }
  int axesOfBand(int l) const { return isotropic_ ? l + 1 : 2 * l + 1; }
  // Returns the number of weights, which is that of the function's coefficients: order (order + 1) / 2 if
  // isotropic, else order².
  int weightCount() const;

  // Computes the weights of a function. Coefficients are ordered as in BrdfTable (if isotropic, only m >= 0,
  // with (l, m) at l(l+1)/2 + m). Weight w_l,i goes to l(l+1)/2 + i if isotropic, else to l² + i.
  void factor(std::span<const float> coefficients, std::span<float> weights) const;

 private:
  int order_;
  bool isotropic_;
  std::vector<glm::vec3> axes_;
  std::vector<double> inverses_;  // inverse matrices y_lm(a_i) of all bands, row-major
};

}  // namespace lambent::sh
