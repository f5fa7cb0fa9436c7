// Computes with zonal functions, which are symmetric about an axis: the clamped cosine, unoccluded diffuse
// transfer, disc lights, zonal rotation and convolution. A zonal function is given by its n coefficients z_l
// about its own axis: f = sum_l z_l y_l0. Angles are in radians, directions are unit vectors towards the
// light, radiance is linear RGB. Sources: Ramamoorthi and Hanrahan 2001 (A_l); Sloan 2008, "Stupid Spherical
// Harmonics Tricks" (zonal rotation, convolution).
#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "runtime/sh/light_vector.hpp"

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
void rotateZonal(int order, std::span<const double> zonal, const glm::vec3& dir, std::span<float> out);
void rotateZonal(int order, std::span<const double> zonal, const glm::dvec3& dir, std::span<double> out);

// Convolves light with a zonal kernel: band l is scaled by sqrt(4pi/(2l+1)) zonal[l].
LightVector convolved(const LightVector& light, std::span<const double> zonal);

// Returns irradiance / pi as a function of the normal, which is light with band l scaled by A_l/pi. Uniform
// light stays unchanged.
LightVector cosineConvolved(const LightVector& light);

}  // namespace lambent::sh
