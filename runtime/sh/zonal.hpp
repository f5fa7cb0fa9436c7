// Functions with an axis of symmetry (zonal harmonics, m = 0) and what follows from them in closed form: the
// clamped cosine, unoccluded diffuse transfer, disc lights, zonal rotation and convolution. Angles are in
// radians, directions are unit vectors that point towards the light, radiance is linear RGB. A zonal function
// is given by its n coefficients z_l about its own axis: f = sum_l z_l y_l0. Sources: Ramamoorthi and
// Hanrahan 2001 (A_l); Sloan 2008, "Stupid Spherical Harmonics Tricks" (zonal rotation, convolution).
#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "runtime/sh/light_vector.hpp"

namespace lambent::sh {

// A_l, by which convolution with max(cos, 0) scales band l: pi, 2pi/3, pi/4, 0, -pi/24, 0, pi/64, 0, ...
double clampedCosine(int l);

// Legendre polynomial P_l(t).
double legendre(int l, double t);

// t_i = (A_l/pi) y_i(normal): diffuse transfer of an open point, the receiver's albedo left out. out: order²
// entries.
void unoccludedTransfer(int order, const glm::vec3& normal, std::span<float> out);
void unoccludedTransfer(int order, const glm::dvec3& normal, std::span<double> out);

// z_l of a disc (or far sphere) of angular radius a and radiance 1 about its axis: 0 <= a <= pi (clamped).
double discZonal(int l, double angular_radius_rad);

// A uniform disc of light about dir: the sun, a far spherical lamp. At a radius of pi it is constantLight.
LightVector discLight(int order, const glm::vec3& dir, double angular_radius_rad,
                      const glm::vec3& radiance_rgb);

// The same radiance from everywhere.
LightVector constantLight(int order, const glm::vec3& radiance_rgb);

// Coefficients of the zonal function zonal[0..order-1] with its axis turned to dir. out: order² entries.
void rotateZonal(int order, std::span<const double> zonal, const glm::vec3& dir, std::span<float> out);
void rotateZonal(int order, std::span<const double> zonal, const glm::dvec3& dir, std::span<double> out);

// Convolution with a zonal kernel given by its zonal coefficients: band l is scaled by sqrt(4pi/(2l+1))
// zonal[l].
LightVector convolved(const LightVector& light, std::span<const double> zonal);

// Irradiance divided by pi as a function of the normal: band l scaled by A_l/pi. Uniform light stays as it
// is.
LightVector cosineConvolved(const LightVector& light);

}  // namespace lambent::sh
