#include "baker/plan/lobe_energy.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

double lobeEnergyShare(double roughness, int order) {
  const double alpha = std::max(roughness * roughness, 1e-3), a2 = alpha * alpha;
  // Seen along the normal the lobe is zonal, and the half vector is at half the angle. Steps are even in
  // x = atan(tan(theta/2) / alpha), in which the lobe is smooth however narrow it is.
  constexpr int kSteps = 2000;
  std::vector<double> zonal(static_cast<std::size_t>(order), 0.0);
  double all = 0.0;
  const double last = std::atan(1.0 / alpha);  // theta = 90 degrees
  for (int i = 0; i < kSteps; ++i) {
    const double x = (i + 0.5) / kSteps * last;
    const double tan_half = alpha * std::tan(x);
    const double cos_h2 = 1.0 / (1.0 + tan_half * tan_half);
    const double cosine = 2.0 * cos_h2 - 1.0, sine = 2.0 * tan_half * cos_h2;
    const double slope = 2.0 * cos_h2 * alpha / (std::cos(x) * std::cos(x));  // d theta / d x
    const double weight = 2.0 * std::numbers::pi * sine * slope * last / kSteps;
    // The value is D G2 / (4 n.v n.l) times n.l at n.v = 1, up to a constant factor; G2 is the
    // height-correlated Smith term.
    const double bottom = cos_h2 * (a2 - 1.0) + 1.0;
    const double d = 1.0 / (bottom * bottom);
    const double value = d * cosine / (cosine + std::sqrt(a2 + (1.0 - a2) * cosine * cosine));
    all += weight * value * value;
    for (int l = 0; l < order; ++l)
      zonal[static_cast<std::size_t>(l)] +=
          weight * value * sh::legendre(l, cosine) * std::sqrt((2 * l + 1) / (4.0 * std::numbers::pi));
  }
  double carried = 0.0;
  for (const double z : zonal) carried += z * z;
  return carried / all;
}

}  // namespace lambent::baker
