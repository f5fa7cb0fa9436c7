// Limits how far the wheel moves the camera of lambent-demo.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

namespace lambent::demo {

inline constexpr float kZoomPerNotch = 0.9f;
// Farther away a scene is a dot, and nearer its centre there is nothing to look at.
inline constexpr float kFarthestRadii = 12.0f, kNearestRadii = 0.05f;
// The camera keeps this distance from the surface in front of it.
inline constexpr float kGapRadii = 0.03f;

// Returns the distance to the scene's centre after so many notches of the wheel. Distances are in radii of
// the scene; surface: from the camera to the surface in the middle of the picture, if there is one.
inline float zoomed(float distance, float notches, std::optional<float> surface) {
  const float wanted = std::clamp(distance * std::pow(kZoomPerNotch, notches), kNearestRadii,
                                  std::max(kFarthestRadii, distance));
  if (notches <= 0.0f || !surface) return wanted;
  return std::max(wanted, std::min(distance, distance - *surface + kGapRadii));
}

}  // namespace lambent::demo
