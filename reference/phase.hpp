// Evaluates and samples the phase function of Henyey and Greenstein, Astrophysical Journal 93, 1941, per
// steradian. Its argument is the cosine between the directions of propagation before and after scattering;
// its mean cosine is g. A path from the eye that travels along d and looks towards s sees light that came
// along -s and left along -d, so the cosine is dot(d, s).
#pragma once

#include <algorithm>
#include <cmath>

#include "reference/sampler.hpp"

namespace lambent::baker::reference {

inline float phaseValue(float g, float cosine) {
  const double k = double{g};
  // (1 - g)² + 2g(1 - cos) is 1 + g² - 2g cos without its cancellation.
  const double base = (1.0 - k) * (1.0 - k) + 2.0 * k * (1.0 - double{cosine});
  return static_cast<float>((1.0 - k * k) / (4.0 * std::numbers::pi * base * std::sqrt(base)));
}

// Returns the first SH bands of the function, as runtime and baker use it: Σ_(l < bands) g^l (2l + 1)/(4π)
// P_l. The result can be negative.
inline float phaseValue(float g, float cosine, int bands) {
  const double c = double{cosine};
  double below = 0.0, legendre = 1.0, power = 1.0, sum = 0.0;
  for (int l = 0; l < bands; ++l) {
    sum += power * (2 * l + 1) * legendre;
    const double above = ((2 * l + 1) * c * legendre - l * below) / (l + 1);
    below = legendre;
    legendre = above;
    power *= double{g};
  }
  return static_cast<float>(sum / (4.0 * std::numbers::pi));
}

// Samples a direction with pdf = phaseValue(g, dot(along, result)); `along` is unit.
inline glm::vec3 samplePhase(float g, const glm::vec3& along, const glm::vec2& u) {
  const double k = double{g}, even = 1.0 - 2.0 * double{u.x};
  double cosine = even;
  if (std::abs(k) > 1e-4) {
    const double share = (1.0 - k * k) / (1.0 + k * even);
    cosine = (1.0 + k * k - share * share) / (2.0 * k);
  } else {
    cosine += 1.5 * k * (1.0 - even * even);  // first-order term in g
  }
  cosine = std::clamp(cosine, -1.0, 1.0);
  const auto sine = static_cast<float>(std::sqrt(1.0 - cosine * cosine));
  const float turn = 2.0f * kPi * u.y;
  return glm::normalize(frameAbout(along) *
                        glm::vec3(sine * std::cos(turn), sine * std::sin(turn), static_cast<float>(cosine)));
}

}  // namespace lambent::baker::reference
