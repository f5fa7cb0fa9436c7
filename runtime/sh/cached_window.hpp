// The window of a light that changes from frame to frame: searched for anew only where the light's shape
// changed. One that is as strong as before times some factor, in each channel another if need be, keeps its
// window, for that depends on the shape alone.
#pragma once

#include "runtime/sh/window.hpp"

namespace lambent::sh {

// Whether b is a times a positive factor in each channel, up to 1e-6 of its norm. Not if anything is not
// finite.
bool sameShape(const LightVector& a, const LightVector& b);

class CachedWindow {
 public:
  // Whether follow() would have nothing to do.
  bool fits(const LightVector& light, Window window) const;
  void follow(const LightVector& light, Window window);
  // Of the light that was followed last; all 1 before.
  const BandWeights& weights() const { return weights_; }

 private:
  LightVector made_from_{.order = 0};
  Window window_ = Window::Off;
  BandWeights weights_ = [] {
    BandWeights ones;
    ones.fill(1.0f);
    return ones;
  }();
};

}  // namespace lambent::sh
