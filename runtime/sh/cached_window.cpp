#include "runtime/sh/cached_window.hpp"

#include <glm/vec3.hpp>

namespace lambent::sh {

bool sameShape(const LightVector& a, const LightVector& b) {
  if (a.order != b.order) return false;
  constexpr double kTolerance = 1e-6;
  glm::dvec3 of_a(0.0), of_b(0.0), of_both(0.0);
  for (std::size_t i = 0; i < a.coefficients().size(); ++i) {
    const glm::dvec3 x(a.c[i]), y(b.c[i]);
    of_a += x * x;
    of_b += y * y;
    of_both += x * y;
  }
  glm::dvec3 factor(1.0);
  for (int k = 0; k < 3; ++k) {
    if (of_a[k] == 0.0 && of_b[k] == 0.0) continue;
    if (!(of_both[k] > 0.0)) return false;
    factor[k] = of_both[k] / of_a[k];
  }
  // The sums above lose digits by cancellation, so the remainder is computed from the coefficients.
  glm::dvec3 left(0.0);
  for (std::size_t i = 0; i < a.coefficients().size(); ++i) {
    const glm::dvec3 apart = glm::dvec3(b.c[i]) - factor * glm::dvec3(a.c[i]);
    left += apart * apart;
  }
  for (int k = 0; k < 3; ++k)
    if (!(left[k] <= kTolerance * kTolerance * of_b[k])) return false;
  return true;
}

bool CachedWindow::fits(const LightVector& light, Window window) const {
  return window == window_ &&
         (window == Window::Auto ? sameShape(made_from_, light) : light.order == made_from_.order);
}

void CachedWindow::follow(const LightVector& light, Window window) {
  if (fits(light, window)) return;
  made_from_ = light;
  window_ = window;
  weights_ = windowWeights(light, window);
}

}  // namespace lambent::sh
