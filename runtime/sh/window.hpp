// Windows against ringing: a truncated expansion of a bright, small light swings below zero, and the shaded
// picture shows dark rings. A window scales band l of the LIGHT by w_l <= 1, once per frame, and never
// touches transfer. Hann: w_l = (1 + cos(pi l / n)) / 2, always on, broad. Auto: w_l = 1 / (1 + lambda
// l²(l+1)²) (Sloan 2008, eq. for the squared Laplacian) with one lambda for all channels: the least that
// leaves no negative irradiance in any channel for any normal; lights that do not ring pass unchanged.
// Irradiance, not radiance, is held non-negative: that is what an unshadowed diffuse surface shows, and it
// asks for far less blur. Lambda depends on the light's shape only, not on its scale or its rotation (up to
// the search's tolerance, about 1e-4 of the mean irradiance).
#pragma once

#include <array>

#include "runtime/sh/light_vector.hpp"

namespace lambent::sh {

enum class Window { Off, Hann, Auto };

using BandWeights = std::array<float, kMaxOrder>;

BandWeights hannWeights(int order);
BandWeights laplacianWeights(int order, double lambda);

// The lambda of Auto: 0 when no channel rings. How it is found: irradiance of each channel at a fixed set of
// 1024 directions; lambda by doubling from 2^-12 until no value is negative, then by bisection; then the
// minima over the whole sphere by descent from the six lowest of those directions that lie 0.3 rad apart;
// minima found negative join the set and the search repeats, until there is none. It aims at a minimum of
// 1e-5 of the channel's mean, as a guard for rounding. Left out are channels that no window can help: those
// whose first coefficient is not above 1e-6 of their largest. With non-finite coefficients the answer is 0.
double deringingLambda(const LightVector& light);

BandWeights windowWeights(const LightVector& light, Window window);
LightVector applyWindow(const LightVector& light, Window window);
LightVector applyWeights(const LightVector& light, const BandWeights& weights);

}  // namespace lambent::sh
