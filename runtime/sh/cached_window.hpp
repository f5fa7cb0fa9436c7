// Keeps the window of a light that changes from frame to frame. The window depends on the light's shape
// alone, so it is searched for again only if the shape changes, not if a channel is scaled.
#pragma once

#include "runtime/sh/window.hpp"

namespace lambent::sh {

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
  BandWeights weights_ = [] {
    BandWeights ones;
    ones.fill(1.0f);
    return ones;
  }();
};

}  // namespace lambent::sh
