// Windows reduce ringing. The truncated expansion of a bright, small light becomes negative in places, and
// the picture shows dark rings. A window scales band l of the LIGHT by w_l <= 1 once per frame and never
// changes transfer.
//
// Auto: w_l = 1 - a + a k_l. The blend a in [0, 1] is the same for all channels, and is the smallest that
// makes no channel negative in any direction, so lights that do not ring stay unchanged. A light that is
// nowhere negative shades nothing negative behind any occluder: radiance is the integral of light times
// visibility times cosine, and truncated light times truncated transfer is exactly this integral over the
// truncated light. k_l are the bands of the non-negative zonal polynomial of degree n - 1 that keeps most of
// band 1. Convolution with it makes every expansion of a real light non-negative, so a = 1 always suffices,
// and no other non-negative kernel keeps more of band 1. At order 5 it keeps .77, .49, .22, .06 of bands 1 to
// 4, where a Laplacian window that suffices for a point light keeps .44, .08, .02, .01. The blend depends on
// the light's shape only, not on its scale or rotation, up to the tolerance of the search, 1e-3.
#pragma once

#include <array>

#include "runtime/sh/basis.hpp"

namespace lambent::sh {

enum class Window { Off, Auto };

using BandWeights = std::array<float, kMaxOrder>;

// Returns k_l of the extremal polynomial of Gauss quadrature. For odd orders the polynomial is (p(t) / (t -
// x))², where p is the Legendre polynomial of degree (order + 1) / 2 and x its largest zero. For even orders
// p is the Jacobi (0, 1) polynomial, and a factor (1 + t) is added. k_1 = x.
BandWeights positiveWeights(int order);

BandWeights windowWeights(const LightVector& light, Window window);
LightVector applyWindow(const LightVector& light, Window window);
LightVector applyWeights(const LightVector& light, const BandWeights& weights);

// Keeps the window of a light that changes from frame to frame. The window depends on the light's shape
// alone, so it is searched for again only if the shape changes, not if a channel is scaled.

// Returns whether each channel of b is a positive multiple of that of a, up to 1e-6 of its norm. Returns
// false if anything is not finite.
bool sameShape(const LightVector& a, const LightVector& b);

class CachedWindow {
 public:
  // Returns whether the weights already belong to this light and window.
  bool fits(const LightVector& light, Window window) const;
  // Updates the weights to this light and window.
  void follow(const LightVector& light, Window window);
  // Returns the weights of the last light; all are 1 before the first.
  const BandWeights& weights() const { return weights_; }

 private:
  LightVector made_from_{.order = 0};
  Window window_ = Window::Off;
  BandWeights weights_ = windowWeights({.order = kMaxOrder}, Window::Off);
};

}  // namespace lambent::sh
