// Windows against ringing: a truncated expansion of a bright, small light swings below zero, and the shaded
// picture shows dark rings. A window scales band l of the LIGHT by w_l <= 1, once per frame, and never
// touches transfer. Hann: w_l = (1 + cos(pi l / n)) / 2, always on, broad. Auto: w_l = 1 - a + a k_l with one
// a in [0, 1] for all channels, the least that leaves no channel of the light negative in any direction;
// lights that do not ring pass unchanged. A light that is nowhere negative shades nothing negative, whatever
// stands in its way: radiance is the integral of light times visibility times cosine, and the truncated light
// times the truncated transfer is exactly that integral over the truncated light. k_l are the bands of the
// non-negative zonal polynomial of the order's degree that keeps most of band 1. Convolving with it blurs as
// little as any non-negative kernel can, and leaves every expansion of a real light non-negative, so that a =
// 1 always suffices. At order 5 it keeps .77, .49, .22, .06 of bands 1 to 4 (a Laplacian window strong enough
// for a point light keeps .44, .08, .02, .01).
// The blend depends on the light's shape only, not on its scale or rotation (up to the search's tolerance,
// 1e-3).
#pragma once

#include <array>

#include "runtime/sh/light_vector.hpp"

namespace lambent::sh {

enum class Window { Off, Hann, Auto };

using BandWeights = std::array<float, kMaxOrder>;

BandWeights hannWeights(int order);

// k_l above; source: the extremal polynomial of Gauss quadrature, (p(t) / (t - x))² with x the largest zero
// of p, p the Legendre polynomial of degree (order + 1) / 2 for odd orders; (1 + t) times that with Jacobi
// (0, 1) for even ones. k_1 = x.
BandWeights positiveWeights(int order);

// The blend a of Auto: 0 when no channel rings. Channels whose mean is not positive are left out (no window
// can help them), and so is a light with coefficients that are not finite.
double deringingBlend(const LightVector& light);

BandWeights windowWeights(const LightVector& light, Window window);
LightVector applyWindow(const LightVector& light, Window window);
LightVector applyWeights(const LightVector& light, const BandWeights& weights);

}  // namespace lambent::sh
